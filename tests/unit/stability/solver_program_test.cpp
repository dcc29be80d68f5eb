// What is made of the program sdpa: of one that fails, writes nonsense or is interrupted, and of a machine without room
// for its files. Its place is taken by a script.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/time.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "../../../controller/stability/src/gain_search.hpp"
#include "../refusal.hpp"
#include "breakaway/stability/lmi.hpp"
#include "two_mass_example.hpp"

namespace solver_program_test {
namespace {

using namespace breakaway::stability;
using breakaway::testing::refusal;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// An environment variable with another value, for a while.
class Environment {
 public:
  Environment(const char* name, const std::string& value) : name_{name} {
    if (const char* const before = std::getenv(name); before != nullptr) before_ = before, had_ = true;
    setenv(name, value.c_str(), 1);
  }
  ~Environment() { had_ ? setenv(name_, before_.c_str(), 1) : unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
  std::string before_;
  bool had_ = false;
};

// A program sdpa that runs these lines of the shell, in which $4 is the file for its result. No other is found.
class StandIn {
 public:
  explicit StandIn(const std::string& lines) : folder_{made()}, path_{"PATH", folder_.string() + ":/usr/bin:/bin"} {
    std::ofstream{folder_ / "sdpa"} << "#!/bin/sh\n" << lines << '\n';
    std::filesystem::permissions(folder_ / "sdpa", std::filesystem::perms::owner_all);
  }
  ~StandIn() { std::filesystem::remove_all(folder_); }
  StandIn(const StandIn&) = delete;
  StandIn& operator=(const StandIn&) = delete;

 private:
  static std::filesystem::path made() {
    std::string name = (std::filesystem::temp_directory_path() / "stand-in-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error{"no temporary folder for the test"};
    return name;
  }

  std::filesystem::path folder_;
  Environment path_;
};

// What sdpa writes of a solution.
std::string writing(const std::string& phase, const std::string& solution) {
  return "printf 'phase.value  = " + phase + "     \\nxVec = \\n{" + solution + "}\\n' > \"$4\"";
}

// min x with x >= 0.
LmiProblem smallest_number() {
  return {VectorXd::Ones(1), {{MatrixXd::Zero(1, 1), {{0, MatrixXd::Ones(1, 1)}}}}, {}, {}};
}

std::string what_is_said() {
  return refusal([] { minimised(smallest_number()); });
}

TEST(SolverProgram, IsBelievedWhenItSaysThatItsSolutionIsFeasible) {
  for (const char* const phase : {"pdOPT", "pdFEAS", "pFEAS"}) {
    const StandIn sdpa{writing(phase, "+2.5e-01")};
    EXPECT_EQ(minimised(smallest_number())[0], 0.25) << phase;
  }
}

TEST(SolverProgram, WithoutASolutionIsNotBelieved) {
  for (const auto& [lines, says] : {
           std::pair{writing("pINF", "+0"), "found no solution of the linear matrix inequalities (pINF)"},
           {std::string{"echo hello > \"$4\""}, "found no solution of the linear matrix inequalities (no result)"},
           {writing("pdOPT", "here it is"), "wrote no solution that can be read"},
           {writing("pdOPT", "nan"), "wrote no solution that can be read"},
           {writing("pdOPT", "1e999"), "wrote no solution that can be read"},
           {writing("pdOPT", ""), "wrote no solution that can be read"},
           {std::string{"exit 3"}, "failed with exit code 3; run it by hand to see why"},
           {writing("pdOPT", "+1") + "; exit 3", "failed with exit code 3; run it by hand to see why"},
           {std::string{"kill -9 $$"}, "failed with exit code 1; run it by hand to see why"},
           {std::string{"exit 0"}, "failed with exit code 0; run it by hand to see why"},
       }) {
    const StandIn sdpa{lines};
    EXPECT_NE(what_is_said().find(says), std::string::npos) << lines << ": " << what_is_said();
  }
}

TEST(SolverProgram, NeedsAFolderForItsFiles) {
  const StandIn sdpa{writing("pdOPT", "+1")};
  for (const char* const folder : {"/nowhere/at/all", "/proc"}) {
    const Environment temporary{"TMPDIR", folder};
    EXPECT_NE(what_is_said().find("cannot write files for the solver sdpa; set TMPDIR"), std::string::npos) << folder;
  }
}

// A limit for the size of files stands for a disk that is full.
TEST(SolverProgram, NeedsRoomForItsFiles) {
  const StandIn sdpa{writing("pdOPT", "+1")};
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto on_full = std::signal(SIGXFSZ, SIG_IGN);
  std::string no_room, little_room;
  for (const auto& [bytes, said] : {std::pair{0, &no_room}, {200, &little_room}}) {
    rlimit limit = before;
    limit.rlim_cur = static_cast<rlim_t>(bytes);
    setrlimit(RLIMIT_FSIZE, &limit);
    *said = what_is_said();
    setrlimit(RLIMIT_FSIZE, &before);
  }
  std::signal(SIGXFSZ, on_full);
  EXPECT_NE(no_room.find("cannot write files for the solver sdpa"), std::string::npos) << no_room;
  EXPECT_NE(little_room.find("cannot write files for the solver sdpa"), std::string::npos)
      << "the problem fits and the parameters do not: " << little_room;
}

void do_nothing(int) {}

TEST(SolverProgram, IsWaitedForAcrossSignals) {
  const StandIn sdpa{"sleep 0.2; " + writing("pdOPT", "+1")};
  struct sigaction interrupt {
  }, before{};
  interrupt.sa_handler = do_nothing;  // without SA_RESTART, so that it ends every wait
  ASSERT_EQ(sigaction(SIGALRM, &interrupt, &before), 0);
  const itimerval every_20_ms{{0, 20000}, {0, 20000}}, never{};
  setitimer(ITIMER_REAL, &every_20_ms, nullptr);
  double found = 0;
  const std::string said = refusal([&] { found = minimised(smallest_number())[0]; });
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
  EXPECT_EQ(said, "");
  EXPECT_EQ(found, 1);
}

// Whoever ignores the end of its children never learns how they ended.
TEST(SolverProgram, ThatEndsUnseenCountsAsFailed) {
  const StandIn sdpa{writing("pdOPT", "+1")};
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  const std::string said = what_is_said();
  std::signal(SIGCHLD, before);
  EXPECT_NE(said.find("the solver sdpa failed with exit code 1"), std::string::npos) << said;
}

// Two masses that friction holds and a spring joins, each with an actuator; by gains of position they can rest
// anywhere.
ActuatedSystem joined_masses() {
  LinearMachine<> machine = two_mass_example(0);
  machine.stiffness << 1, -1, -1, 1;
  return {machine, MatrixXd::Identity(2, 2)};
}

TEST(SolverProgram, ThatFindsASingularComplianceIsRefused) {
  const StandIn sdpa{writing("pFEAS", "0, 0, 0, 0, 0, 0, 0, 0, 0")};
  const std::string said = refusal([] { synthesize(joined_masses(), {.resting_error_m = 0.5}, GainStructure::full); });
  EXPECT_NE(said.find("returned gains that do not make K_cl positive definite"), std::string::npos) << said;
}

// The gains of velocity of a machine whose position needs none.
std::string velocity_refusal(const LinearMachine<>& machine, const PdWants& wants) {
  return refusal([&] { synthesize({machine, MatrixXd::Identity(2, 2)}, wants, GainStructure::full); });
}

TEST(SolverProgram, ThatFindsNoGainOfVelocityGivesTheReason) {
  const StandIn sdpa{writing("pINF", "0")};
  for (const double region_J : {50.0, std::numeric_limits<double>::infinity()}) {
    const std::string said = velocity_refusal(two_mass_example(), {.region_J = region_J});
    EXPECT_NE(said.find("found no solution of the linear matrix inequalities (pINF)"), std::string::npos) << said;
  }
}

// A negative damper of each mass is no answer to a wish for attraction from everywhere; friction holds it somewhere.
TEST(SolverProgram, WhoseGainsAreTooWeakIsToldWhatTheyReach) {
  const StandIn sdpa{writing("pFEAS", "-1, 0, -1, 0")};
  const std::string said = velocity_refusal(two_mass_example(), {.region_J = std::numeric_limits<double>::infinity()});
  EXPECT_NE(said.find("the region is out of reach: with these actuators the best found is "), std::string::npos)
      << said;
  EXPECT_EQ(said.find("inf"), std::string::npos) << said;
}

// A damping with a skew part and no unstable direction: only its symmetry needs a gain.
TEST(SolverProgram, IsAskedToTakeASkewPartOfTheDampingAway) {
  LinearMachine<> machine = two_mass_example();
  machine.damping << 1, 0.25, -0.25, 1;
  const StandIn sdpa{"exit 3"};
  const std::string said = velocity_refusal(machine, {.region_J = 1});
  EXPECT_NE(said.find("the solver sdpa failed with exit code 3"), std::string::npos) << said;
}

// The limit of damping is found, and then no gain for it.
TEST(SolverProgram, ThatGivesUpHalfwayGivesTheReason) {
  const StandIn sdpa{"if [ -e \"$0.once\" ]; then " + writing("pdINF", "0") + "; else touch \"$0.once\"; " +
                     writing("pdOPT", "0, 0, 0, 1, 1") + "; fi"};
  const std::string said = velocity_refusal(two_mass_example(), {.region_J = 50});
  EXPECT_NE(said.find("found no solution of the linear matrix inequalities (pdINF)"), std::string::npos) << said;
}

TEST(LeastEigenvalueLimits, OfAMatrixBeyondAllNumbersIsNotProved) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(proven_least_eigenvalue(1e200 * MatrixXd::Identity(1, 1)), -infinity);
  EXPECT_FALSE(proven_least_eigenvalue(MatrixXd::Constant(2, 2, infinity)) > 0);
}

}  // namespace
}  // namespace solver_program_test
