#include "breakaway/input/file_roles.hpp"

#include <cstddef>
#include <filesystem>
#include <system_error>

#include "breakaway/input/input_error.hpp"

namespace breakaway {
namespace {

namespace fs = std::filesystem;

bool given(const NamedFile& file) { return !file.path.empty(); }

// Standard input can be given out once.
void require_one_from_standard_input(const std::vector<NamedFile>& read) {
  const NamedFile* first = nullptr;
  for (const NamedFile& input : read) {
    if (input.path != "-") continue;
    if (first != nullptr)
      throw InputError{"-: two inputs would come from there, " + first->option + " and " + input.option +
                       "; give one of them a file"};
    first = &input;
  }
}

void require_not_read(const NamedFile& output, const std::vector<NamedFile>& read) {
  std::error_code ignored;
  for (const NamedFile& input : read) {
    if (!given(input) || !same_file(output.path, input.path) || !fs::is_regular_file(input.path, ignored)) continue;
    throw InputError{output.path + ": " + output.option + " would write over a file that is read; give another name"};
  }
}

}  // namespace

bool same_file(const std::string& a, const std::string& b) {
  if (a == b) return true;
  if (a == "-" || b == "-") return false;
  std::error_code unknown;
  if (fs::equivalent(a, b, unknown)) return true;
  const fs::path one = fs::weakly_canonical(fs::absolute(a, unknown), unknown);
  if (unknown) return false;
  const fs::path other = fs::weakly_canonical(fs::absolute(b, unknown), unknown);
  return !unknown && one == other;
}

void require_apart(const std::vector<NamedFile>& read, const std::vector<NamedFile>& written) {
  require_one_from_standard_input(read);
  for (std::size_t i = 0; i < written.size(); ++i) {
    const NamedFile& output = written[i];
    if (!given(output)) continue;
    require_not_read(output, read);
    for (std::size_t before = 0; before < i; ++before) {
      if (given(written[before]) && same_file(output.path, written[before].path))
        throw InputError{output.path + ": two outputs would go there, " + written[before].option + " and " +
                         output.option + "; give each its own file"};
    }
  }
}

}  // namespace breakaway
