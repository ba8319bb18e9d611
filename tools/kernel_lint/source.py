"""Text of a file as tokens, with the marks and findings on its lines."""
import re
from pathlib import Path

TOKEN = re.compile(r"""
    (?P<raw>R"(?P<delim>[^\s()\\]*)\((?P<body>.*?)\)(?P=delim)")
  | (?P<comment>//[^\n]*|/\*.*?\*/)
  | (?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])+')
  | (?P<number>0[xX][0-9a-fA-F']+[uUlLzZ]*|(?:\d[\d']*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[a-zA-Z]*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<op><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|::|[^\s\w])
""", re.X | re.S)


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
