#!/usr/bin/env python3
"""Checks that physics stands only in kernels, and that kernel text rounds the same everywhere.

    tools/check_kernels.py                     the whole tree
    tools/check_kernels.py FILE...             some files
    tools/check_kernels.py --self-test FOLDER  samples whose `// expect: RULE` comments must match

In src/kernels/**/*.inl (the common subset of C++20 and GLSL):
    call      only pc_ and PC_ names, functions of the kernels, and constructors may be called
    division  no operator / on reals: devices round it differently
    precise   a sum, difference or product of reals is the initialiser of a `precise` local
    literal   constants of reals stand in PC_REAL(...)
In src/cpu, src/glcompute and src/step (loops and bindings only; lanes*.h and prelude*.h define the types):
    backend   no floating-point literal, arithmetic or mathematical function
Anywhere:
    unread    a statement with arithmetic that this checker cannot read
    marker    `lint: allow` without a reason

`// lint: allow (reason)` excuses its own line and the next one, `// lint: allow-file (reason)` the file.
"""
import re
import sys
from pathlib import Path

CURES = {
    "call": "use a pc_ function of math.inl, or add one there",
    "division": "use pc_div(a, b)",
    "precise": "give the result a name first: precise Real x = ...;",
    "literal": "write PC_REAL({})",
    "backend": "move it into a kernel in src/kernels (times: count nanoseconds as integers)",
    "unread": "write it as simple declarations and assignments",
    "marker": "write // lint: allow (reason)",
}
TOKEN = re.compile(r"""
    (?P<raw>R"(?P<delim>[^\s()\\]*)\((?P<body>.*?)\)(?P=delim)")
  | (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
  | (?P<number>0[xX][0-9a-fA-F']+[uUlLzZ]*|(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[a-zA-Z]*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<op><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|::|[^\s\w])
""", re.X | re.S)
INTEGER_TYPES = {"uint", "int", "Index", "Slot", "bool", "uint32_t", "size_t"}
KEYWORDS = {"if", "for", "while", "switch", "return", "else", "do", "case"}
BANNED = set("""abs sign floor ceil trunc round roundEven fract mod modf min max clamp mix step smoothstep isnan isinf fma ldexp
    frexp sqrt inversesqrt pow exp exp2 log log2 sin cos tan asin acos atan atan2 sinh cosh tanh radians degrees length distance
    dot cross normalize reflect refract faceforward inverse transpose determinant outerProduct float double vec2 vec3 vec4
    dvec2 dvec3 dvec4 mat3 mat4""".split())


class Token:
    def __init__(self, kind, text, line):
        self.kind, self.text, self.line = kind, text, line

    def is_float(self):
        return self.kind == "number" and not self.text.lower().startswith("0x") and (
            "." in self.text or re.search(r"\d[eE][+-]?\d", self.text) or re.search(r"[fF]$", self.text))


class Source:
    """Tokens of one file without comments and directives, its macros, and its marks."""

    def __init__(self, path, text=None, first_line=1):
        self.path, self.findings, self.allowed, self.expected = path, [], set(), []
        self.allow_all, self.tokens, self.macros, self.raws = False, [], [], []
        text = Path(path).read_text() if text is None else text
        self.tokens = self.read(text, first_line)

    def report(self, line, rule, what):
        self.findings.append((line, rule, what))

    def open_findings(self):
        seen, result = set(), []
        for line, rule, what in sorted(self.findings):
            excused = rule != "marker" and (self.allow_all or line in self.allowed)
            if not excused and (line, rule, what) not in seen:
                seen.add((line, rule, what))
                result.append((line, rule, what))
        return result

    def read(self, text, line):
        out, at = [], 0
        while at < len(text):
            if text[at] == "#" and not text[text.rfind("\n", 0, at) + 1:at].strip():
                end = re.compile(r"(?<!\\)\n|\Z").search(text, at).start()
                self.directive(text[at:end], line)
                line, at = line + text.count("\n", at, end), end
                continue
            match = TOKEN.match(text, at)
            if not match:
                line, at = line + (text[at] == "\n"), at + 1
                continue
            if match["comment"]:
                self.mark(match["comment"], line)
            elif match["raw"]:
                self.raws.append((match["body"], line))
                out.append(Token("string", '""', line))
            else:
                kind = match.lastgroup
                out.append(Token(kind, match[kind], line))
            line, at = line + match[0].count("\n"), match.end()
        return out

    def directive(self, text, line):
        comment = re.search(r"//[^\n]*$", text)
        if comment:
            self.mark(comment[0], line)
            text = text[:comment.start()]
        match = re.match(r"#\s*define\s+(\w+)(\(([^)]*)\))?(.*)", text, re.S)
        if match:
            self.macros.append((match[1], match[3], self.read(match[4].replace("\\\n", " \n"), line)))

    def mark(self, comment, line):
        for expected in re.findall(r"expect: (\w+)", comment):
            self.expected.append((line, expected))
        match = re.search(r"lint: allow(-file)?\s*(\(\s*[^)\s][^)]*\))?", comment)
        if not match:
            return
        if not match[2]:
            self.report(line, "marker", "an exception without a reason")
        elif match[1]:
            self.allow_all = True
        else:
            self.allowed |= {line, line + comment.count("\n") + 1}


# ---- kernels ---------------------------------------------------------------------------------------
class Unreadable(Exception):
    pass


class Names:
    """What all kernel files declare: functions and whether they return integers, integer constants and members."""

    def __init__(self, sources):
        self.functions, self.integers, self.integer_members = {}, set(), set()
        for source in sources:
            t = source.tokens
            for i in range(len(t) - 2):
                if t[i].kind != "name" or t[i + 1].kind != "name":
                    continue
                integer = t[i].text in INTEGER_TYPES
                if t[i + 2].text == "(" and t[i].text not in KEYWORDS:
                    self.functions[t[i + 1].text] = integer
                elif t[i + 2].text == "=" and integer and i > 0 and t[i - 1].text == "const":
                    self.integers.add(t[i + 1].text)
                elif t[i + 2].text == ";" and integer:
                    self.integer_members.add(t[i + 1].text)
            for name, parameters, body in source.macros:
                if parameters is None and body and all(
                        b.text in "()+-*" or b.text in self.integers or (b.kind == "number" and not b.is_float()) for b in body):
                    self.integers.add(name)


class Kernel:
    """Reads one kernel file statement by statement."""

    def __init__(self, source, names):
        self.source, self.names, self.scope = source, names, {}
        self.block(source.tokens)
        for _, parameters, body in source.macros:
            if body:
                self.scope = {}
                self.block(body)

    def block(self, tokens):
        statement, parens, braces = [], 0, 0
        for token in tokens:
            if token.text == ";" and not any(t.text == "for" for t in statement):
                parens = 0  # a missing parenthesis must not hide the rest of the file
            if parens == 0 and token.text in (";", "{", "}"):
                if token.text == "{" and braces == 0:
                    self.header(statement)
                else:
                    self.guarded(statement)
                braces = max(0, braces + (token.text == "{") - (token.text == "}"))
                statement = []
                continue
            parens = max(0, parens + (token.text == "(") - (token.text == ")"))
            statement.append(token)
        self.guarded(statement)

    def header(self, tokens):
        """Parameters of a function become its scope."""
        self.scope = {}
        texts = [t.text for t in tokens]
        if "(" not in texts:
            return
        parameter, depth = [], 0
        for token in tokens[texts.index("(") + 1:]:
            if depth == 0 and token.text in (",", ")"):
                if len(parameter) > 1:
                    self.scope[parameter[-1].text] = any(p.text in INTEGER_TYPES for p in parameter[:-1])
                parameter = []
                continue
            depth += (token.text == "(") - (token.text == ")")
            parameter.append(token)

    def guarded(self, tokens):
        try:
            self.statement(tokens)
        except (Unreadable, IndexError):
            for token in tokens:
                if token.text in ("+", "-", "*", "/", "+=", "-=", "*=", "/="):
                    self.source.report(token.line, "unread", "a statement that the checker cannot read")
                    return

    def statement(self, tokens):
        while tokens and tokens[0].text in ("else", "do", "const", "break", "continue"):
            tokens = tokens[1:]
        if not tokens or tokens[0].text in ("struct", "case", "default"):
            return
        head = tokens[0].text
        if head in ("if", "while", "switch", "for") and tokens[1].text == "(":
            close = matching(tokens, 1)
            for part in split(tokens[2:close], ";"):
                self.statement(part)
            self.statement(tokens[close + 1:])
        elif head == "return":
            self.expression(tokens[1:], False)
        elif len(self.scope) == 0 and re.fullmatch(r"PC_[A-Z0-9_]+", head) and head != "PC_FN" and self.is_list(tokens):
            return
        else:
            precise = head == "precise"
            body = tokens[1:] if precise else tokens
            if len(body) > 1 and body[0].kind == "name" and body[1].kind == "name":
                for part in split(body[1:], ","):
                    self.scope[part[0].text] = body[0].text in INTEGER_TYPES
                    self.initialiser(part, precise)
            else:
                self.initialiser(body, False)

    @staticmethod
    def is_list(tokens):
        """Entries of an X-macro list stand outside functions, without semicolons."""
        i = 0
        while i < len(tokens):
            if tokens[i].kind != "name" or i + 1 >= len(tokens) or tokens[i + 1].text != "(":
                return False
            i = matching(tokens, i + 1) + 1
        return True

    def initialiser(self, tokens, precise):
        depth = 0
        for i, token in enumerate(tokens):
            depth += (token.text in "([") - (token.text in ")]")
            if depth == 0 and token.text in ("=", "+=", "-=", "*=", "/=", "%=", "|=", "&=", "^=", "<<=", ">>="):
                integer = self.expression(tokens[:i], False)
                value = self.expression(tokens[i + 1:], precise and token.text == "=")
                if token.text in ("+=", "-=", "*=", "/=") and not (integer and value):
                    self.source.report(token.line, "precise", f"`{token.text}` on reals")
                return
        self.expression(tokens, False)

    # An expression's value is True when it is an integer, else False.
    def expression(self, tokens, precise):
        if not tokens:
            return True
        value, end = self.ternary(tokens, 0, precise)
        while end < len(tokens) and tokens[end].text == ",":
            value, end = self.ternary(tokens, end + 1, precise)
        if end != len(tokens):
            raise Unreadable
        return value

    def ternary(self, t, i, precise):
        value, i = self.binary(t, i, precise)
        if i < len(t) and t[i].text == "?":
            yes, i = self.ternary(t, i + 1, precise)
            if t[i].text != ":":
                raise Unreadable
            no, i = self.ternary(t, i + 1, precise)
            value = yes and no
        return value, i

    COMPARES = ("<", ">", "<=", ">=", "==", "!=", "&&", "||")
    INTEGER_OPS = ("%", "&", "|", "^", "<<", ">>")

    def binary(self, t, i, precise):
        value, i = self.unary(t, i, precise)
        compared = False
        while i < len(t) and t[i].text in ("+", "-", "*", "/") + self.COMPARES + self.INTEGER_OPS:
            op = t[i]
            right, i = self.unary(t, i + 1, precise)
            if op.text in self.COMPARES:
                value, compared = right, True
                continue
            if op.text in ("+", "-", "*", "/") and not (value and right):
                if op.text == "/":
                    self.source.report(op.line, "division", "operator / on reals")
                elif not precise:
                    self.source.report(op.line, "precise", f"`{op.text}` on reals outside a precise initialiser")
                value = False
            elif op.text in self.INTEGER_OPS:
                value = True
        return value or compared, i

    def unary(self, t, i, precise):
        if i >= len(t):
            raise Unreadable
        if t[i].text in ("-", "+", "!", "~"):
            return self.unary(t, i + 1, precise)
        if t[i].text in ("++", "--"):
            value, end = self.unary(t, i + 1, precise)
            if not value:
                self.source.report(t[i].line, "precise", f"`{t[i].text}` on a real")
            return value, end
        return self.postfix(t, i, precise)

    def postfix(self, t, i, precise):
        token = t[i]
        if token.text == "(":
            close = matching(t, i)
            value, i = self.expression(t[i + 1:close], precise), close + 1
        elif token.kind == "number":
            value, i = not token.is_float(), i + 1
            if not value:
                self.source.report(token.line, "literal", token.text)
        elif token.kind == "name":
            value, i = self.name(t, i, precise)
        else:
            raise Unreadable
        while i < len(t) and t[i].text in (".", "[", "++", "--"):
            if t[i].text == ".":
                value, i = t[i + 1].text in self.names.integer_members, i + 2
                if i < len(t) and t[i].text == "(":
                    self.source.report(t[i].line, "call", f".{t[i - 1].text}(...)")
                    i = matching(t, i) + 1
            elif t[i].text == "[":
                close = matching(t, i)
                self.expression(t[i + 1:close], False)
                i = close + 1
            else:
                if not value:
                    self.source.report(t[i].line, "precise", f"`{t[i].text}` on a real")
                i += 1
        return value, i

    def name(self, t, i, precise):
        name = t[i].text
        if i + 1 < len(t) and t[i + 1].text == "::":
            self.source.report(t[i].line, "call", f"{name}:: is not in the common subset")
            raise Unreadable
        if i + 1 >= len(t) or t[i + 1].text != "(":
            if name == "PC_PASS":  # a macro that stands before an argument
                return self.postfix(t, i + 1, precise)
            return self.scope.get(name, name in self.names.integers or name in ("true", "false")), i + 1
        close = matching(t, i + 1)
        if name == "PC_REAL":  # the only home of constants; a quotient of literals is folded by the compiler
            return False, close + 1
        constructor = name in INTEGER_TYPES or bool(re.match(r"[A-Z][a-z]", name))
        known = name.startswith(("pc_", "PC_")) or name in self.names.functions
        if name in BANNED or not (constructor or known):
            self.source.report(t[i].line, "call", f"{name}(...)")
        for argument in split(t[i + 2:close], ","):
            self.expression(argument, precise and constructor)
        integer = name in INTEGER_TYPES if constructor else self.names.functions.get(name, False)
        return integer, close + 1


def matching(tokens, i):
    pairs, depth = {"(": ")", "[": "]"}, 0
    opened, closed = tokens[i].text, pairs[tokens[i].text]
    for k in range(i, len(tokens)):
        depth += (tokens[k].text == opened) - (tokens[k].text == closed)
        if depth == 0:
            return k
    raise Unreadable


def split(tokens, separator):
    parts, depth = [[]], 0
    for token in tokens:
        depth += (token.text in ("(", "[")) - (token.text in (")", "]"))
        if depth == 0 and token.text == separator:
            parts.append([])
        else:
            parts[-1].append(token)
    return [p for p in parts if p]


# ---- backends --------------------------------------------------------------------------------------
REALS = {"Real", "Scalar", "float", "double", "Vec3", "Quad", "Quaternion", "Sym3", "Lanes", "vec3", "vec4", "dvec3", "dvec4"}
FUNCTIONS = set("sqrt sin cos tan asin acos atan atan2 exp log pow fma floor ceil fabs hypot inversesqrt dot cross normalize length".split())


def check_backend(source):
    t = source.tokens
    values, arrays = set(), set()
    for i in range(len(t) - 1):
        if t[i].text not in REALS:
            continue
        k = i + 1
        array = False
        while k < len(t) and t[k].text in ("*", "&", ">", "const"):
            array, k = array or t[k].text in ("*", ">"), k + 1
        if k < len(t) and t[k].kind == "name" and not (k + 1 < len(t) and t[k + 1].text == "("):
            (arrays if array or (k + 1 < len(t) and t[k + 1].text == "[") else values).add(t[k].text)

    def real_before(i):
        if t[i].text == "]":
            while i > 0 and t[i].text != "[":
                i -= 1
            return i > 0 and t[i - 1].text in arrays
        if t[i].text == ")":
            depth, k = 0, i
            while k >= 0:
                depth += (t[k].text == ")") - (t[k].text == "(")
                if depth == 0:
                    break
                k -= 1
            return k > 0 and (t[k - 1].text in REALS or (t[k - 1].text == ">" and t[k - 2].text in REALS))
        return t[i].text in values

    def real_after(i):
        while i < len(t) and t[i].text in ("-", "+", "(", "*", "&"):
            i += 1
        if i >= len(t) or t[i].kind != "name":
            return False
        if t[i].text in REALS or (t[i].text == "static_cast" and i + 2 < len(t) and t[i + 2].text in REALS):
            return True
        while i + 2 < len(t) and t[i + 1].text in (".", "->", "::"):
            i += 2
        if i + 1 < len(t) and t[i + 1].text == "[":
            return t[i].text in arrays
        return t[i].text in values

    for i, token in enumerate(t):
        if token.is_float():
            source.report(token.line, "backend", f"the floating-point literal {token.text}")
        elif token.text in FUNCTIONS and i + 1 < len(t) and t[i + 1].text == "(" and (i == 0 or t[i - 1].text not in (".", "->")):
            source.report(token.line, "backend", f"the mathematical function {token.text}")
        elif token.text in ("+", "-", "*", "/", "+=", "-=", "*=", "/=") and 0 < i < len(t) - 1:
            left = t[i - 1]
            operand = left.kind in ("name", "number") or left.text in (")", "]")
            declares = token.text == "*" and left.text in REALS  # `float* p`, not a product
            if operand and not declares and left.text != "return" and (real_before(i - 1) or real_after(i + 1)):
                source.report(token.line, "backend", f"`{token.text}` on reals")
    for body, line in source.raws:  # GLSL text inside C++
        inner = Source(source.path, body, line)
        check_backend(inner)
        source.findings += inner.open_findings()
        source.expected += inner.expected


# ---- the tree --------------------------------------------------------------------------------------
BACKENDS = ("cpu", "glcompute", "step")


def is_kernel(path):
    return path.suffix == ".inl" and path.parent.name not in BACKENDS


def tree(root):
    files = list(root.glob("src/kernels/**/*.inl"))
    for folder in BACKENDS:
        for suffix in ("cpp", "h", "inl", "glsl"):
            files += [f for f in root.glob(f"src/{folder}/*.{suffix}") if not re.match(r"(lanes|prelude).*\.h$", f.name)]
    return sorted(files)


def check(files):
    sources = [Source(f) for f in files]
    kernels = [s for s in sources if is_kernel(s.path)]
    names = Names(kernels)
    for source in sources:
        if is_kernel(source.path):
            Kernel(source, names)
        else:
            check_backend(source)
    return sources


def self_test(folder):
    sources = check(sorted(f for f in Path(folder).iterdir() if f.suffix in (".inl", ".cpp", ".glsl")))
    failures = 0
    for source in sources:
        found = sorted({(line, rule) for line, rule, _ in source.open_findings()})
        expected = sorted(set(source.expected))
        for line, rule in sorted(set(found) ^ set(expected)):
            failures += 1
            print(f"{source.path}:{line}: {rule} {'was not found' if (line, rule) in expected else 'was not expected'}")
    print(f"{len(sources)} samples, {failures} differences")
    return 1 if failures or not sources else 0


def main(arguments):
    root = Path(__file__).resolve().parent.parent
    if arguments[:1] == ["--self-test"] and len(arguments) == 2:
        return self_test(arguments[1])
    if any(a.startswith("-") for a in arguments):
        print(__doc__)
        return 0 if arguments[0] in ("-h", "--help") else 2
    files = [Path(a).resolve() for a in arguments] or tree(root)
    if arguments:  # kernels know each other's functions and constants, so read them all and report the chosen ones
        files += [f for f in root.glob("src/kernels/**/*.inl") if f not in files]
    chosen = {Path(a).resolve() for a in arguments}
    count = 0
    for source in check(files):
        if chosen and source.path not in chosen:
            continue
        for line, rule, what in source.open_findings():
            count += 1
            shown = source.path.relative_to(root) if source.path.is_relative_to(root) else source.path
            print(f"{shown}:{line}: {rule}: {what}; {CURES[rule].format(what)}")
    print(f"check_kernels: {len(chosen) or len(files)} files, {count} findings")
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
