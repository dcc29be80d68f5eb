// The schema of the files that every other subcommand reads, for editors.
#include "breakaway/report/schema.hpp"

#include <memory>
#include <string>

#include "breakaway/format/output_file.hpp"
#include "breakaway/scenario/known_tables.hpp"
#include "call_files.hpp"
#include "commands.hpp"

namespace breakaway::cli {

void add_schema(CLI::App& app, int& exit_code) {
  const auto file = std::make_shared<std::string>("-");
  CLI::App* command =
      app.add_subcommand("schema", "Write the JSON schema of the TOML files, for editors that complete and check them");
  CallFiles files{*command};
  files.writes("-o,--output", *file, "Write to this file; - is standard output, as without it");
  command->footer(std::string{"Example: breakaway schema -o breakaway.schema.json\n"
                              "and, as the first line of a TOML file: #:schema ./breakaway.schema.json\n"} +
                  exit_codes);
  files.then([file, &exit_code] {
    format::write_output(*file, report::to_json_schema(scenario::known_tables()));
    exit_code = done;
  });
}

}  // namespace breakaway::cli
