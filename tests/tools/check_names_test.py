#!/usr/bin/env python3
"""tools/check-names on small planted sources: what it must find, and what it must leave alone."""

import shutil
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


def check_project(files):
    """The same for a project of files given as {path: text}."""
    with tempfile.TemporaryDirectory() as root:
        for folder in ("core", "drivers", "sim", "tools", "tests"):
            (Path(root) / folder).mkdir()
        for path, text in files.items():
            (Path(root) / path).parent.mkdir(parents=True, exist_ok=True)
            (Path(root) / path).write_text(text, encoding="utf-8")
        copy = shutil.copy(CHECK, Path(root) / "tools")
        run = subprocess.run([sys.executable, copy], capture_output=True, text=True, check=False)
        return run.returncode, run.stdout.replace(root + "/", "")


def helper(parameters, name="helper"):
    return f"namespace luxrig {{\nnamespace {{\n\nint {name}({parameters}) {{ return 1; }}\n}}\n}}\n"


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

    def test_finds_functions_of_two_files_also_with_other_signatures(self):
        code, out = check(a_cpp=helper("int a"), b_cpp=helper("double a, int b"))
        self.assertEqual(code, 1)
        self.assertIn("luxrig::helper is a function of 2 files that are compiled together", out)
        self.assertIn("a.cpp:4", out)
        self.assertIn("b.cpp:4", out)

    def test_finds_functions_of_any_form(self):
        functions = """namespace {
template <class T, int n = 3>
T templated(T t) { return t; }
[[nodiscard]] [[gnu::format(printf, 1, 2)]] int attributed(const char*, ...) { return 1; }
std::function<void(int)> of_a_long_type(int) { return {}; }
int with_defaults(A a = {}, B b = B{1}, int c = 2) { return c; }
int across_lines(int a,
                 int b) {
  return a + b;
}
auto trailing(int a) -> decltype(a) { return a; }
inline decltype(auto) deduced() noexcept(true) { return 1; }
const struct sockaddr* of_c(struct sockaddr* a) { return a; }
}
"""
        code, out = check(a_cpp=functions, b_cpp=functions)
        self.assertEqual(code, 1)
        names = "templated attributed of_a_long_type with_defaults across_lines trailing deduced of_c".split()
        self.assertEqual([line.split()[0] for line in out.splitlines() if " is a function " in line], sorted(names))

    def test_leaves_alone_functions_that_cannot_be_confused(self):
        shared = """namespace luxrig {
namespace {
void declared(int a);
int own(int a) { return a; }
int own(double a) { return 1; }
struct Own%d {
  int member(int a = 1) { return a; }
  Own%d(int a);
  int defined_below() const noexcept(true);
  int a_, b_;
};
Own%d::Own%d(int a) : a_{a}, b_(1) {}
int Own%d::defined_below() const noexcept(true) { return 1; }
struct Of {
  int both() { return 1; }
};
bool operator==(const Own%d& a, const Own%d& b) { return true; }
const int value%d = [](int a) { return a; }(3);
const Sum sum%d = *first(1) + Sum{1};
TEST(Suite%d, Name) { own(2); }
}
int in_a_named_namespace(int a%d) { return a%d; }
}
"""
        one, two = shared.replace("own(", "own1("), shared
        self.assertEqual(check(a_cpp=one.replace("%d", "1"), b_cpp=two.replace("%d", "2")), (0, ""))

    def test_the_same_function_in_other_namespaces_is_another(self):
        other = helper("int a").replace("luxrig", "luxrig::sim")
        self.assertEqual(check(a_cpp=helper("int a"), b_cpp=other), (0, ""))

    def test_compares_the_functions_of_one_library_or_test_program(self):
        together = [
            ("core/show/a.cpp", "core/show/parts/b.cpp"),
            ("core/result.cpp", "core/parallel.cpp"),
            ("drivers/dmx/a.cpp", "drivers/b.cpp"),
            ("tools/luxrig/command_table.cpp", "tools/luxrigd/state/b.cpp"),
            ("tools/process/a.cpp", "tools/terminal/b.cpp"),
            ("tools/bench/a.cpp", "tools/bench/nnls/b.cpp"),
            ("tools/luxrig-sim/a.cpp", "tools/luxrig-sim/main.cpp"),
            ("tests/core/show/a_test.cpp", "tests/core/show/b_test.cpp"),
            ("tests/sim/a_accuracy_test.cpp", "tests/sim/world/b_accuracy_test.cpp"),
            ("tests/broken_drivers/a_test.cpp", "tests/conformance/broken_driver.cpp"),
        ]
        for a, b in together:
            code, out = check_project({a: helper("int a"), b: helper("double a")})
            self.assertEqual(code, 1, (a, b))
            self.assertIn(f"  {a}:4\n", out)
            self.assertIn(f"  {b}:4\n", out)

    def test_leaves_alone_the_functions_of_different_programs(self):
        apart = """core/result.cpp core/show/a.cpp core/rig/a.cpp drivers/a.cpp sim/a.cpp tools/luxrig/a.cpp
            tools/luxrig/main.cpp tools/luxrigd/main.cpp tools/bench/main.cpp tools/http/a.cpp
            tools/process/a.cpp tools/bench/a.cpp tools/bench/rooms/a.cpp tools/bench/methods/a.cpp
            tests/core/show/a_test.cpp tests/core/show/a_accuracy_test.cpp tests/core/show/a_determinism_test.cpp
            tests/core/rig/a_test.cpp tests/drivers/a_test.cpp tests/tools/luxrig/a_test.cpp
            tests/tools/luxrigd/a_test.cpp tests/fuzz/a_fuzz.cpp tests/fuzz/b_fuzz.cpp tests/vm/guest/a.cpp
            tests/vm/guest/b.cpp""".split()
        self.assertEqual(check_project({path: helper("int a") for path in apart}), (0, ""))
        self.assertEqual(check_project({"core/rig/a.h": helper("int a"), "core/rig/b.h": helper("int a")}), (0, ""))

    def test_does_not_compare_the_types_of_tests(self):
        one = "namespace a { struct S { int i; }; }\n"
        self.assertEqual(check_project({"tests/sim/a_test.cpp": one, "tests/drivers/a_test.cpp": one}), (0, ""))
        self.assertEqual(check_project({"sim/a.cpp": one, "drivers/a.cpp": one})[0], 1)

    def test_a_folder_that_is_not_there_is_an_error(self):
        run = subprocess.run([sys.executable, CHECK, "/nowhere/at/all"], capture_output=True, check=False)
        self.assertEqual(run.returncode, 2)


if __name__ == "__main__":
    unittest.main()
