"""Tests of the finder and of the switches, on a source of their own: no mutant of the project is built here."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import mutation_points  # noqa: E402

SAMPLE = """\
#include <algorithm>
#include <chrono>
#include <cstdint>
namespace breakaway {
using Duration = std::chrono::milliseconds;
inline constexpr Duration patience{50};
constexpr int twice(int x) { return x * 2; }
static_assert(twice(2) == 4);
template <class Scalar>
struct Counter {
  Scalar count{0};
  bool late(Duration waited, bool watched) const {
    return watched && waited > patience;
  }
  Scalar limited(Scalar x, Scalar most) { return std::min(x, most); }
  void add(Scalar x) { if (x < 0) return; count += x; }
  bool differs(Duration a, Duration b) const { return a != b; }
};
enum class State : std::uint8_t { off, on };
inline State next(State s) {
  switch (s) {
    case State::off: return State::on;
    case State::on: break;
  }
  return State::off;
}
}
"""

MAIN = """
#include <cstdio>
int main() {
  using namespace breakaway;
  Counter<float> c;
  c.add(2); c.add(-1); c.add(0);
  const bool late[] = {c.late(Duration{50}, true), c.late(Duration{51}, true), c.late(Duration{99}, false)};
  std::printf("%g %d%d%d %g %d%d %d %d\\n", c.count, late[0], late[1], late[2], c.limited(1, 3),
              c.differs(patience, patience), c.differs(patience, Duration{1}),
              static_cast<int>(next(State::on)), twice(3));
}
"""

EXPECTED = [
    "`return x * 2` returns something else", "`x * 2` with /", "`2` off by one", "`0` off by one",
    "`watched && waited > patience` with ||", "`waited > patience` with >=", "`waited > patience` with <=",
    "`patience` off", "`return std::min(x, most)` returns something else", "`std::min(x, most)` with max",
    "`x < 0` with <=", "`x < 0` with >=", "`0` off by one", "`count += x` deleted", "`count += x` with -=",
    "`a != b` with ==",
    "`return State::on` returns something else", "`return State::off` returns something else"]


class Sample(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = pathlib.Path(cls.folder.name) / "sample.cpp"
        cls.path.write_text(SAMPLE)
        cls.points = mutation_points.find_points(mutation_points.Tree([], str(cls.path)), str(cls.path), SAMPLE)
        cls.changes, numbers = [], []
        for point in cls.points:
            numbers.append([len(cls.changes) + 1 + i for i in range(len(point.changes))])
            cls.changes += point.changes
        cls.mutated = mutation_points.apply(SAMPLE, cls.points, numbers)
        main = pathlib.Path(cls.folder.name) / "main.cpp"
        main.write_text(cls.mutated + MAIN)
        cls.program = pathlib.Path(cls.folder.name) / "sample"
        subprocess.run([os.environ.get("CXX", "c++"), "-std=c++20", "-w", "-include", HERE / "switches.hpp", main, "-o",
                        cls.program], check=True, timeout=60)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def result(self, change):
        number = self.changes.index(change) + 1 if change else 0
        environment = os.environ | {"BREAKAWAY_MUTANT": str(number)}
        done = subprocess.run([self.program], env=environment, capture_output=True, text=True, timeout=10)
        return done.stdout.strip()

    def test_keeps_every_line_where_it_is(self):
        self.assertEqual(self.mutated.count("\n"), SAMPLE.count("\n"))

    def test_changes_nothing_unless_a_mutant_is_in(self):
        self.assertEqual(self.result(None), "2 010 1 01 0 6")

    def test_puts_each_known_fault_in(self):
        for change, expected in (
                ("`waited > patience` with >=", "2 110 1 01 0 6"),
                ("`waited > patience` with <=", "2 100 1 01 0 6"),
                ("`watched && waited > patience` with ||", "2 111 1 01 0 6"),
                ("`patience` off", "2 000 1 01 0 6"),
                ("`std::min(x, most)` with max", "2 010 3 01 0 6"),
                ("`count += x` deleted", "0 010 1 01 0 6"),
                ("`count += x` with -=", "-2 010 1 01 0 6"),
                ("`x < 0` with >=", "-1 010 1 01 0 6"),
                ("`a != b` with ==", "2 010 1 10 0 6"),
                ("`return State::off` returns something else", "2 010 1 01 1 6"),
                ("`x * 2` with /", "2 010 1 01 0 1"),
                ("`0` off by one", "3 010 1 01 0 6")):
            with self.subTest(change):
                self.assertEqual(self.result(change), expected)

    def test_leaves_alone_what_only_a_compiler_evaluates(self):
        lines = self.mutated.split("\n")
        for number in (6, 8):  # a constexpr variable and a static assertion
            self.assertNotIn("mutation", lines[number - 1])
        self.assertFalse(any(re.search(r"case .*mutation.*:.*:", line.split("return")[0]) for line in lines))

    def test_finds_these_points_and_no_other(self):
        self.assertEqual(sorted(self.changes), sorted(EXPECTED))


if __name__ == "__main__":
    unittest.main()
