// The files of one call of a subcommand: its options say which it reads and which it writes, and before it runs no
// output may be a file that is read, or another output.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace breakaway::cli {

class CallFiles {
 public:
  // `command` must outlive this, and so must every path until the command has run.
  explicit CallFiles(CLI::App& command) : command_{command} {}

  // A file that is read.
  CLI::Option* reads(const char* name, std::string& path, const char* what);
  CLI::Option* reads(const char* name, std::vector<std::string>& paths, const char* what);

  // A file of results, which replaces an older one. "-" is standard output.
  CLI::Option* writes(const char* name, std::string& path, const char* what);

  // The same for an HTML page: a name that ends as another kind of file does is refused.
  CLI::Option* writes_page(const char* name, std::string& path, const char* what);

  // A file that a person may have changed since: one that is there is replaced if --overwrite is given, which is added,
  // and only then, even if it is one that is read.
  CLI::Option* makes(const char* name, std::string& path, const char* what);

  // What the command does once its files are known to be apart.
  void then(std::function<void()> run);

 private:
  enum class Role { read, written, page, made };
  struct File {
    Role role;
    std::string option;
    std::function<std::vector<std::string>()> paths;
  };

  static void check(const std::vector<File>& files, bool overwrite);
  CLI::Option* add(Role role, const char* name, std::string& path, const char* what);

  CLI::App& command_;
  std::vector<File> files_;
  CLI::Option* overwrite_ = nullptr;
};

}  // namespace breakaway::cli
