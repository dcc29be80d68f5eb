#include "call_files.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "breakaway/input/file_roles.hpp"
#include "breakaway/input/input_error.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

// The short one, if there is one.
std::string name_of(const CLI::Option& option) {
  return option.get_snames().empty() ? option.get_name() : "-" + option.get_snames().front();
}

void require_new(const NamedFile& file) {
  std::error_code unknown;
  if (file.path != "-" && std::filesystem::exists(file.path, unknown))
    throw InputError{file.path + " is there already: give another name with " + file.option + ", or --overwrite"};
}

// A name without an ending promises no other kind of file.
void require_html(const NamedFile& file) {
  const std::string ending = std::filesystem::path{file.path}.extension().string();
  if (!ending.empty() && ending != ".html" && ending != ".htm")
    throw InputError{file.option + ": " + file.path + " ends in " + ending +
                     ", and a page is HTML: give a name in .html; a browser prints it"};
}

}  // namespace

CLI::Option* CallFiles::add(Role role, const char* name, std::string& path, const char* what) {
  CLI::Option* option = command_.add_option(name, path, what)->type_name("FILE");
  files_.push_back({role, name_of(*option), [&path] { return std::vector{path}; }});
  return option;
}

CLI::Option* CallFiles::reads(const char* name, std::string& path, const char* what) {
  return add(Role::read, name, path, what)->check(name_to_read);
}

CLI::Option* CallFiles::reads(const char* name, std::vector<std::string>& paths, const char* what) {
  CLI::Option* option = command_.add_option(name, paths, what)->type_name("FILE")->check(name_to_read);
  files_.push_back({Role::read, name_of(*option), [&paths] { return paths; }});
  return option;
}

CLI::Option* CallFiles::writes(const char* name, std::string& path, const char* what) {
  return add(Role::written, name, path, what)->check(name_to_write);
}

CLI::Option* CallFiles::writes_page(const char* name, std::string& path, const char* what) {
  return add(Role::page, name, path, what)->check(name_to_write);
}

CLI::Option* CallFiles::makes(const char* name, std::string& path, const char* what) {
  CLI::Option* option = add(Role::made, name, path, what)->check(name_to_write);
  overwrite_ = command_.add_flag("--overwrite")->description("Replace the file if it is there");
  return option;
}

void CallFiles::check(const std::vector<File>& files, bool overwrite) {
  std::vector<NamedFile> read, results, pages, made;
  for (const File& file : files) {
    auto& same_role = file.role == Role::read ? read : file.role == Role::made ? made : results;
    for (const std::string& path : file.paths()) {
      same_role.push_back({file.option, path});
      if (file.role == Role::page) pages.push_back(same_role.back());
    }
  }
  if (!overwrite) std::ranges::for_each(made, require_new);
  require_apart(read, results);
  results.insert(results.end(), made.begin(), made.end());
  require_apart({}, results);
  std::ranges::for_each(pages, require_html);
}

void CallFiles::then(std::function<void()> run) {
  command_.callback([files = files_, overwrite = overwrite_, run = std::move(run)] {
    check(files, overwrite != nullptr && overwrite->count() > 0);
    run();
  });
}

}  // namespace breakaway::cli
