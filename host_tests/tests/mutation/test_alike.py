"""By which laws C reads two texts alike, and where it does not."""

from __future__ import annotations

import pytest

from laconic.mutation.alike import meaning, without_growth
from laconic.mutation.operators import parsed


def told(body: str) -> tuple:
    tree = parsed(f"int f(int a, int b, int c, real x, const item *p) {{ {body} }}".encode()).root_node
    assert not tree.has_error, body
    return meaning(tree.children[0])


ALIKE = [
    ("return a + b;", "return b + a;"), ("return a * (b + c);", "return (c + b) * a;"),
    ("return a < b;", "return b > a;"), ("return a <= b;", "return (b >= (a)); /* or equal */"),
    ("return a == b;", "return b == a;"), ("return plus(a, b);", "return plus(b, a);"),
    ("return (a & b) | 1;", "return 1 | (b & a);"),
    ("return x > R(0);", "return x > -R(0);"), ("return x == 0;", "return x == -0;"),
    ("return !(a == b);", "return a != b;"), ("if (a) c++;", "if (a != 0) c++;"),
    ("if (p) c++;", "if (p != NULL) c++;"),
    ("if (!a) c++;", "if (a == 0) c++;"), ("if (!!a) c++;", "if (a) c++;"), ("if (a) c++;", "if (-a) c++;"),
    ("while (a && !b) c++;", "while (-a && b == 0) c++;"), ("if (x != R(0)) c++;", "if (-x != R(0)) c++;"),
    ("return !a ? b : c;", "return a ? c : b;"), ("if (!a) b = 1; else c = 1;", "if (a) c = 1; else b = 1;"),
    ("return (a < b) & (b < c);", "return a < b && b < c;"), ("return a < b | !c;", "return a < b || !c;"),
    ("a = a + b;", "a += b;"), ("a = b * a;", "a *= b;"), ("a = a - b;", "a -= b;"), ("a++;", "++a;"),
    ("a++;", "a += 1;"),
    ("return 0x10;", "return 16;"), ("return 1.50;", "return 15e-1;"), ("return 10U;", "return 0xAu;"),
    ("return 017;", "return 15;"), ("return .5f;", "return 0.5F;"),
    ("return 0.0 + a;", "return a + 0.000;"), ("return x > 0.0;", "return x > -0.00;"), ("return 20.0;", "return 2e1;"),
    ("return R(1) + f(a);", "return f(a) + R(1);"), ("return dot(a, b) + R(1);", "return R(1) + dot(b, a);"),
    ("return 08;", "return 08;"),
    ("return LACONIC_OK;", "return 0;"), ("return true;", "return 1;"), ("f(NULL);", "f(false);"),
    ("if (a) { c = 1; }", "if (a) c = 1;"), ("a = 1; ; b = 2;", "a = 1; b = 2;"),
    ("for (int k = 0; k < 3; k++) a += k;", "for (int k = 0; k != 3; ++k) a += k;"),
    ("for (int k = 0; k < NODES; k++) a += k;", "for (int k = 0; NODES != k; k += 1) a += k;"),
    ("for (int k = 0; k < p->dof && a; k++) a--;", "for (int k = 0; k != p->dof && a; k++) a--;"),
]
OTHERS = [
    ("return a - b;", "return b - a;"), ("return a < b;", "return b < a;"), ("return a < b;", "return a <= b;"),
    ("return (a + b) + c;", "return a + (b + c);"), ("return minus(a, b);", "return minus(b, a);"),
    ("return x > R(0);", "return x > -R(1);"), ("return x - R(0);", "return x - -R(0);"),
    ("return !(x < 1);", "return x >= 1;"),  # not a number
    ("return a != 0;", "return a;"), ("return a;", "return -a;"), ("return !!a;", "return a;"),
    ("if (x > 0) c++;", "if (-x > 0) c++;"), ("return !a ? b : c;", "return a ? b : c;"),
    ("return (a & b) < c;", "return (a && b) < c;"), ("return a < b & f(c);", "return a < b && f(c);"),
    ("return p != NULL & p->dof < 3;", "return p != NULL && p->dof < 3;"),  # reads what the first guards
    ("return b != 0 & a / b < 3;", "return b != 0 && a / b < 3;"), ("a = b - a;", "a -= b;"),
    ("*f(a) = *f(a) + 1;", "*f(a) += 1;"), ("b = a++;", "b = ++a;"), ("return 010;", "return 10;"),
    ("return 1;", "return 1.0;"), ("return 1U;", "return 1;"), ("return 1.5f;", "return 1.5;"),
    ("if (a) { int b = 1; c = b; }", "if (a) c = b;"),
    ("for (int k = 4; k < 3; k++) a += k;", "for (int k = 4; k != 3; k++) a += k;"),
    ("for (int k = 0; k < 3; k += 2) a += k;", "for (int k = 0; k != 3; k += 2) a += k;"),
    ("for (int k = 0; k < 3; k++) k += a;", "for (int k = 0; k != 3; k++) k += a;"),
    ("for (int k = 0; k < 3; k++) t[k++] = a;", "for (int k = 0; k != 3; k++) t[k++] = a;"),
    ("for (int k = 0; k < 3; k++) f(&k);", "for (int k = 0; k != 3; k++) f(&k);"),
    ("for (int k = 0; k < 1.5; k++) a += k;", "for (int k = 0; k != 1.5; k++) a += k;"),
    ("for (int k = 0; k < p->dof; k++) p->dof -= 2;", "for (int k = 0; k != p->dof; k++) p->dof -= 2;"),
    ("return f(a) + f(b);", "return f(b) + f(a);"), ("return f(a) | a++;", "return a++ | f(a);"),
    ("return 0.1l;", "return 0.1000000000000000000001l;"), ("return 1e400;", "return 1e999;"),
    ('f("NULL");', 'f("false");'),
    ("for (int k = 0; k < a; k++) b++;", "for (int k = 0; k != a; k++) b++;"),
    ("for (int k = a; k < NODES; k++) b++;", "for (int k = a; k != NODES; k++) b++;"),
    ("for (; a < 3;) b++;", "for (; b < 3;) b++;"), ("for (a = 1;;) b++;", "for (; a = 1;) b++;"),
]


@pytest.mark.parametrize(("one", "other"), ALIKE)
def test_these_are_alike(one, other):
    assert told(one) == told(other)


@pytest.mark.parametrize(("one", "other"), OTHERS)
def test_these_are_not(one, other):
    assert told(one) != told(other)


@pytest.mark.parametrize(("longer", "is_alike"), [
    ("int t[4]", True), ("int t[N + 3]", False), ("int t[2]", False), ("int t[3 + 1]", True), ("long t[4]", False)])
def test_an_array_of_a_function_may_be_longer(longer, is_alike):
    before, after = told("int t[3] = {0}; return p->f(&t[a]);"), told(f"{longer} = {{0}}; return p->f(&t[a]);")
    assert before != after and (without_growth(before, after) == before) is is_alike


@pytest.mark.parametrize(("length", "is_alike"), [
    ("N + 3", True), ("N * 2", True), ("2 * N", True), ("N", True), ("2 + N", True), ("N - 1", False), ("N / 2", False),
    ("N * 0", False), ("M + 3", False)])
def test_an_array_of_a_named_length_grows_by_it(length, is_alike):
    before, after = told("int t[N]; return t[a];"), told(f"int t[{length}]; return t[a];")
    assert (without_growth(before, after) == before) is is_alike
    before, after = told("int t[N + 2]; return t[a];"), told("int t[N + 1]; return t[a];")
    assert without_growth(before, after) != before


@pytest.mark.parametrize("size", ["sizeof t", "sizeof(t) / sizeof(t)[0]", "COUNT(t)", "*(&t + 1) - t"])
def test_where_something_asks_its_size_it_may_not(size):
    before, after = told(f"int t[3]; return {size};"), told(f"int t[4]; return {size};")
    assert without_growth(before, after) != before


@pytest.mark.parametrize("element", ["WHERE(a, t[0], t[COUNT(u)])", "sizeof t[0]", "R(t[a])"])
def test_where_an_element_alone_is_given_to_a_macro_it_may(element):
    before, after = told(f"int t[3], u[2]; return {element};"), told(f"int t[4], u[2]; return {element};")
    assert without_growth(before, after) == before


def test_a_macro_that_is_given_an_array_for_an_index_may_ask_its_size():
    before, after = told("int t[3]; return WHERE(u[COUNT(t)]);"), told("int t[4]; return WHERE(u[COUNT(t)]);")
    assert without_growth(before, after) != before


@pytest.mark.parametrize(("type_", "is_alike"), [("bool", True), ("static inline verdict", True), ("int", False)])
def test_of_what_a_truth_is_given_only_whether_it_is_0_counts(type_, is_alike):
    def of(value: str) -> tuple:
        text = f"{type_} f(int a) {{ if (a > 7) return g(a); return {value}; }}"
        return meaning(parsed(text.encode()).root_node.children[0])

    assert (of("a") == of("-a")) is (of("a") == of("a != 0")) is is_alike
    assert of("a") != of("!a") and of("a") != of("b")


def test_the_first_length_of_a_parameter_says_nothing_and_the_second_does():
    def of(parameter: str) -> tuple:
        return meaning(parsed(f"int f(int {parameter}) {{ return 1; }}".encode()).root_node.children[0])

    assert of("a[3]") == of("a[4]") and of("a[2][3]") == of("a[3][3]") != of("a[2][4]") and of("a[3]") != of("b[3]")
