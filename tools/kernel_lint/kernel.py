"""Rules of kernel text: call, division, precise, literal, bare, reserved, nodes, unread."""
import re

INTEGER_TYPES = {"uint", "int", "Index", "Row", "Slot", "bool", "uint32_t", "size_t"}
BARE = {"0.0", "0.5", "1.0", "2.0"}  # numbers that need no name
MATH = {"math.inl", "math_angles.inl", "math_decay.inl"}  # files of polynomials, where no number needs one
LOOPS = {"PC_NODES", "PC_DOWN", "PC_UP", "PC_CHILDREN", "PC_ALL"}  # over nodes, see nodes.inl
KEYWORDS = {"if", "for", "while", "switch", "return", "else", "do", "case"}
BANNED = set("""abs sign floor ceil trunc round roundEven fract mod modf min max clamp mix step smoothstep isnan isinf fma ldexp
    frexp sqrt inversesqrt pow exp exp2 log log2 sin cos tan asin acos atan atan2 sinh cosh tanh radians degrees length distance
    dot cross normalize reflect refract faceforward inverse transpose determinant outerProduct float double vec2 vec3 vec4
    dvec2 dvec3 dvec4 mat3 mat4""".split())

# words of GLSL 4.30 that C++ takes for names
RESERVED = set("""common partition active filter input output sample subroutine shared resource superp noinline external interface
    half fixed cast attribute varying coherent patch centroid flat smooth noperspective invariant uniform layout buffer discard
    lowp mediump highp in out inout""".split())


class Unreadable(Exception):
    pass


class Names:
    """What all kernel files declare: functions and whether they return integers, integer constants and members."""

    def __init__(self, sources):
        self.functions, self.integers, self.integer_members = {}, {"PC_W"}, set()  # PC_W: lanes of a block
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
        self.names_numbers = source.path.name in MATH  # or the body of a macro without parameters
        for before, token in zip(source.tokens, source.tokens[1:]):
            if before.kind == token.kind == "name" and token.text in RESERVED:
                source.report(token.line, "reserved", token.text)
        self.block(source.tokens)
        for _, parameters, body in source.macros:
            if body:
                self.scope = {}
                self.names_numbers = parameters is None or source.path.name in MATH
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
        while tokens and tokens[0].text in ("else", "do", "const", "break", "continue", "PC_ONE"):
            tokens = tokens[1:]
        if not tokens or tokens[0].text in ("struct", "case", "default"):
            return
        head = tokens[0].text
        if head in ("if", "while", "switch", "for") and tokens[1].text == "(":
            close = matching(tokens, 1)
            if head == "for" and any(a.text == "t" and c.text == "count" for a, c in zip(tokens[:close], tokens[2:close])):
                self.source.report(tokens[0].line, "nodes", "a loop over the nodes of a tree")
            for part in split(tokens[2:close], ";"):
                self.statement(part)
            self.statement(tokens[close + 1:])
        elif head in LOOPS and tokens[1].text == "(":
            self.scope[tokens[2].text] = True
            self.statement(tokens[matching(tokens, 1) + 1:])
        elif head == "PC_THEN" and tokens[1].text == "(":
            self.statement(tokens[2:matching(tokens, 1)])
            self.statement(tokens[matching(tokens, 1) + 1:])
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
            for number in t[i + 2:close]:
                if number.kind == "number" and number.text not in BARE and not self.names_numbers:
                    self.source.report(number.line, "bare", number.text)
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
