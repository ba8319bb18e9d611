"""The rule of backends: loops and bindings, no arithmetic of physics."""
from .source import Source

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
