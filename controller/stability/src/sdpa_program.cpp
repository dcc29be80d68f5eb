#include "sdpa_program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace breakaway::stability {
namespace {

// These are SDPA's own defaults but for the last digits of the result and the size of the starting point. Its reader
// expects the lines in this order.
constexpr const char* solver_parameters = R"(200     unsigned int maxIteration;
1.0E-8  double 0.0 < epsilonStar;
1.0E4   double 0.0 < lambdaStar;
2.0     double 1.0 < omegaStar;
-1.0E5  double lowerBound;
1.0E5   double upperBound;
0.1     double 0.0 <= betaStar <  1.0;
0.2     double 0.0 <= betaBar  <  1.0, betaStar <= betaBar;
0.9     double 0.0 < gammaStar  <  1.0;
1.0E-8  double 0.0 < epsilonDash;
%+.17e  char*  xPrint
NOPRINT char*  XPrint
NOPRINT char*  YPrint
%+.17e  char*  infPrint
)";

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code none;
    const std::filesystem::path parent = std::filesystem::temp_directory_path(none);
    std::string name = (parent / "breakaway-XXXXXX").string();
    if (!none && mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (made()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  bool made() const { return !path_.empty(); }
  std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

bool written(const std::string& file, const std::string& text) {
  std::ofstream out{file, std::ios::binary};
  out << text;
  return out.flush().good();
}

// Runs without a shell, and without a word on the streams. Returns the exit code, 127 when there is no such program.
int exit_code_of(std::array<std::string, 7> arguments) {
  std::array<char*, 8> argv{};
  for (std::size_t i = 0; i < arguments.size(); ++i) argv[i] = arguments[i].data();
  posix_spawn_file_actions_t silence;
  posix_spawn_file_actions_init(&silence);
  posix_spawn_file_actions_addopen(&silence, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&silence, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, argv[0], &silence, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&silence);
  if (failed != 0) return 127;
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return 1;
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace

std::string sdpa_result(const std::string& problem) {
  const TemporaryFolder folder;
  if (!folder.made() || !written(folder.file("problem.dat-s"), problem) ||
      !written(folder.file("parameters"), solver_parameters)) {
    throw InputError{
        "cannot write files for the solver sdpa; set TMPDIR to a folder that you may write and that has room"};
  }
  const int exit_code = exit_code_of(
      {"sdpa", "-ds", folder.file("problem.dat-s"), "-o", folder.file("result"), "-p", folder.file("parameters")});
  if (exit_code == 127) {
    throw InputError{"the solver sdpa cannot be run, and full gains need it; install the package sdpa"};
  }
  std::ifstream in{folder.file("result"), std::ios::binary};
  std::ostringstream result;
  result << in.rdbuf();
  if (exit_code != 0 || result.str().empty()) {
    throw InputError{"the solver sdpa failed with exit code " + std::to_string(exit_code) +
                     "; run it by hand to see why"};
  }
  return result.str();
}

}  // namespace breakaway::stability
