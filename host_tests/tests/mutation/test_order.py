"""Which statements may change places or come twice without a word, and which may not."""

from __future__ import annotations

import pytest

from laconic.mutation.alike import meaning
from laconic.mutation.operators import parsed
from laconic.mutation.order import without_order


def told(body: str) -> tuple:
    tree = parsed(f"int f(int a, int b, int c, real x, item *p) {{ {body} }}".encode()).root_node
    assert not tree.has_error, body
    return without_order(meaning(tree.children[0]))


ALIKE = [
    ("return f(a) + f(b);", "return f(b) + f(a);"), ("a = 1; b = 2;", "b = 2; a = 1;"),
    ("p->u = x; p->v = q->w / x;", "p->v = q->w / x; p->u = x;"),
    ("m[a][b] += x * p->u; m[a + 1][b] += x * p->v;", "m[a + 1][b] += x * p->v; m[a][b] += x * p->u;"),
    ("m[0] = x; m[1] = a;", "m[1] = a; m[0] = x;"), ("f(a); a = 1; b = 2; g(b);", "f(a); b = 2; a = 1; g(b);"),
    ("p->q[2].z = R(0); p->q[1].z = R(0);", "p->q[1].z = R(0); p->q[2].z = R(0);"),
    ("real y = x; real z = x; a = 1;", "real z = x; a = 1; real y = x;"), ("a = b;", "a = b; a = b;"),
    ("memset(p, 0, sizeof *p);", "memset(p, 0, sizeof *p); memset(p, 0, sizeof *p);"),
    ("if (a) { b = 1; c = 2; }", "if (a) { c = 2; b = 1; }"),
]
OTHERS = [
    ("a = 1; b = a;", "b = a; a = 1;"), ("a = 1; a = 2;", "a = 2; a = 1;"), ("a = b; b = c;", "b = c; a = b;"),
    ("memset(p++, 0, 1);", "memset(p++, 0, 1); memset(p++, 0, 1);"),
    ("put16(p, a++);", "put16(p, a++); put16(p, a++);"),
    ("put16(p, f(a));", "put16(p, f(a)); put16(p, f(a));"), ("s->put16(p);", "s->put16(p); s->put16(p);"),
    ("f(a); b = 2;", "b = 2; f(a);"), ("f(a);", "f(a); f(a);"), ("a = f(&b); c = b;", "c = b; a = f(&b);"),
    ("a += b;", "a += b; a += b;"), ("a = a + b;", "a = a + b; a = a + b;"), ("a++;", "a++; a++;"),
    ("m[a] = 1; m[b] = 2;", "m[b] = 2; m[a] = 1;"), ("m[a] = 1; a = 2;", "a = 2; m[a] = 1;"),
    ("m[a + b] = 1; m[a] = 2;", "m[a] = 2; m[a + b] = 1;"),
    ("p->q = s; a = p->q.z;", "a = p->q.z; p->q = s;"), ("*p = a; a = 2;", "a = 2; *p = a;"),
    ("a = *p; *q = 1;", "*q = 1; a = *p;"), ("a = b++; c = 1;", "c = 1; a = b++;"),
    ("a = 1; if (b) return c;", "if (b) return c; a = 1;"), ("return a; b = 1;", "b = 1; return a;"),
    ("real y = x; a = y;", "a = y; real y = x;"), ("a = 1; b = a; a = 1;", "a = 1; b = a;"),
]


@pytest.mark.parametrize(("one", "other"), ALIKE)
def test_the_order_of_these_says_nothing(one, other):
    assert told(one) == told(other)


@pytest.mark.parametrize(("one", "other"), OTHERS)
def test_these_say_something_else(one, other):
    assert told(one) != told(other)
