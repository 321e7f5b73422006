#!/usr/bin/env python3
"""tools/check-names on small planted sources: what it must find, and what it must leave alone."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

CHECK = Path(__file__).resolve().parents[2] / "tools" / "check-names"


def check(**files):
    """Exit code and output for files given as name=text; `_h` and `_cpp` stand for the suffixes."""
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            stem, suffix = name.rsplit("_", 1)
            (Path(folder) / f"{stem}.{suffix}").write_text(text, encoding="utf-8")
        run = subprocess.run([sys.executable, CHECK, folder], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout.replace(folder + "/", "")


class CheckNames(unittest.TestCase):
    def test_finds_two_definitions_and_says_where(self):
        code, out = check(
            a_cpp="#include <x>\nnamespace luxrig {\nstruct Hit {\n  int a;\n};\n}\n",
            b_h="namespace luxrig {\n\nclass Hit final : public Base {\n int b = {};\n};\n}\n",
        )
        self.assertEqual(code, 1)
        self.assertIn("luxrig::Hit is defined 2 times", out)
        self.assertIn("a.cpp:3", out)
        self.assertIn("b.h:3", out)

    def test_finds_enums_unions_nested_and_templates(self):
        one = "namespace a::b { enum class Kind : int { x }; struct Out { struct In { int i; }; }; "
        one += "template <class T = int> struct Box { T t; }; union U { int i; }; }\n"
        two = "namespace a { namespace b { enum Kind { y }; } }\nnamespace a::b { struct Out2 {}; "
        two += "template <typename T> class Box { }; union U { char c; }; struct Out { struct In {}; }; }\n"
        code, out = check(a_h=one, b_cpp=two)
        self.assertEqual(code, 1)
        for name in ("a::b::Kind", "a::b::Box", "a::b::U", "a::b::Out ", "a::b::Out::In"):
            self.assertIn(name, out)
        self.assertNotIn("Out2", out)

    def test_leaves_alone_what_cannot_clash(self):
        declared = """namespace luxrig {
struct Forward;
namespace {
struct Own { int a; };
namespace inner { struct Deep {}; }
}
int f() { struct Local { int i; }; return Local{}.i; }
struct Forward g(struct Forward* p) { return *p; }
auto h = [] { struct InLambda {}; };
template <class Own> void t(Own) { }
template <> struct Special<int> { };
}  // namespace luxrig
"""
        other = declared.replace("Special<int>", "Special<char>")
        self.assertEqual(check(a_cpp=declared, b_cpp=other), (0, ""))

    def test_is_not_misled_by_comments_literals_and_macros(self):
        noisy = """// struct A {
/* struct B { */
#define OPEN struct C { \\
  int x;
namespace luxrig {
const char* text = "} struct D {";
const char* raw = R"(} } struct E { ")";
constexpr int n = 10'000; char brace = '{';
struct Real%d { int i = 1'000; };
}
"""
        self.assertEqual(check(a_cpp=noisy % 1, b_cpp=noisy % 2), (0, ""))
        self.assertEqual(check(a_cpp=noisy % 1, b_cpp=noisy % 1)[0], 1)

    def test_the_same_name_in_other_namespaces_is_another_name(self):
        code, out = check(
            a_cpp="namespace a { struct S {}; }", b_cpp="namespace b { struct S {}; }", c_cpp="struct S {};"
        )
        self.assertEqual((code, out), (0, ""))

    def test_a_folder_that_is_not_there_is_an_error(self):
        run = subprocess.run([sys.executable, CHECK, "/nowhere/at/all"], capture_output=True, check=False)
        self.assertEqual(run.returncode, 2)


if __name__ == "__main__":
    unittest.main()
