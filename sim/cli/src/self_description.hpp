// What the command says of itself to shells and manuals, from the same options that it reads.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace breakaway::cli {

// The subcommand, or the option of the chosen one, that was probably meant: ", did you mean simulate?"; nothing where
// none is near.
std::string did_you_mean(const CLI::App& app, const std::string& word);

// For bash, and for zsh behind bashcompinit: subcommands, their options, and file names elsewhere.
std::string bash_completion(const CLI::App& app);

// A page for man(1).
std::string man_page(const CLI::App& app, const std::string& version);

// Adds `help`.
void add_help(CLI::App& app, int& exit_code);

}  // namespace breakaway::cli
