#include "self_description.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

#include "breakaway/input/edit_distance.hpp"
#include "commands.hpp"

namespace breakaway::cli {
namespace {

using Apps = std::vector<const CLI::App*>;

Apps subcommands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

// Those of no group are for the command itself, and --help does not show them either.
std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : shown_options(app)) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

std::vector<std::string> names_of(const Apps& apps) {
  std::vector<std::string> names;
  for (const CLI::App* app : apps) names.push_back(app->get_name());
  return names;
}

std::string joined(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

// A backslash begins a request in roff, and so does a point or an apostrophe that begins a line.
std::string roff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\n' && escaped.ends_with('\n')) {
      escaped += ".PP\n";
      continue;
    }
    if ((c == '.' || c == '\'') && (escaped.empty() || escaped.ends_with('\n'))) escaped += "\\&";
    escaped += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return escaped;
}

std::string man_options(const CLI::App& app) {
  std::string text;
  for (const CLI::Option* option : shown_options(app))
    text += fmt::format(".TP\n.B {}\n{}\n", roff(option->get_name(true, true)), roff(option->get_description()));
  return text;
}

// CLI::App::help() would tell of the subcommand that is being run, which is `help`.
std::string help_of(const CLI::App& app, const std::string& name) {
  return app.get_formatter()->make_help(&app, name, CLI::AppFormatMode::Normal);
}

int help(const CLI::App& app, const std::string& topic) {
  if (topic.empty()) {
    fmt::print("{}", help_of(app, app.get_name()));
    return done;
  }
  for (const CLI::App* command : subcommands(app)) {
    if (command->get_name() != topic) continue;
    fmt::print("{}", help_of(*command, app.get_name() + " " + topic));
    return done;
  }
  throw CLI::ExtrasError{topic + " is no subcommand" + did_you_mean(app, topic), CLI::ExitCodes::ExtrasError};
}

}  // namespace

std::string did_you_mean(const CLI::App& app, const std::string& word) {
  std::vector<std::string> candidates = word.starts_with('-') ? option_names(app) : names_of(subcommands(app));
  const auto distance = [&](const std::string& name) { return edit_distance(word, name); };
  const auto nearest = std::ranges::min_element(candidates, {}, distance);
  // A third of a word may be wrong.
  const bool near = nearest != candidates.end() && distance(*nearest) * 3 <= std::max(word.size(), nearest->size());
  return near ? fmt::format(", did you mean {}?", *nearest) : "";
}

std::string bash_completion(const CLI::App& app) {
  std::string cases;
  for (const CLI::App* command : subcommands(app))
    cases += fmt::format("    {}) words='{}' ;;\n", command->get_name(), joined(option_names(*command)));
  return fmt::format(
      R"(# bash completion for {0}, written by `{0} help --completion`
_{0}() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} words
  case ${{COMP_WORDS[1]}} in
{1}    *) words='{2} {3}' ;;
  esac
  if [[ $COMP_CWORD -eq 1 ]]; then
    COMPREPLY=($(compgen -W '{2} {3}' -- "$word"))
  elif [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  elif [[ ${{COMP_WORDS[1]}} == help ]]; then
    COMPREPLY=($(compgen -W '{2}' -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -o filenames -F _{0} {0}
)",
      app.get_name(), cases, joined(names_of(subcommands(app))), joined(option_names(app)));
}

std::string man_page(const CLI::App& app, const std::string& version) {
  std::string text = fmt::format(".TH BREAKAWAY 1 \"\" \"breakaway {}\"\n.SH NAME\n{} \\- {}\n", version,
                                 app.get_name(), roff(app.get_description()));
  text +=
      fmt::format(".SH SYNOPSIS\n.B {}\n[OPTION] SUBCOMMAND ...\n.SH OPTIONS\n{}", app.get_name(), man_options(app));
  text += ".SH SUBCOMMANDS\n";
  for (const CLI::App* command : subcommands(app)) {
    text += fmt::format(".SS {}\n{}\n{}", command->get_name(), roff(command->get_description()), man_options(*command));
    if (const std::string footer = command->get_footer(); !footer.empty())
      text += fmt::format(".PP\n{}\n", roff(footer));
  }
  return text;
}

void add_help(CLI::App& app, int& exit_code) {
  struct Asked {
    std::string topic;
    bool completion = false, man = false;
  };
  const auto asked = std::make_shared<Asked>();
  CLI::App* command = app.add_subcommand("help", "Say what a subcommand does, as its --help");
  command->add_option("subcommand", asked->topic, "What to tell of; without it all are listed");
  CLI::Option* completion = command->add_flag("--completion", asked->completion, "Write completions for bash instead");
  command->add_flag("--man", asked->man, "Write the manual page instead")->excludes(completion);
  command->footer(std::string{"Example: breakaway help design\n"} + exit_codes);
  command->callback([asked, &app, &exit_code] {
    if (asked->completion) {
      fmt::print("{}", bash_completion(app));
    } else if (asked->man) {
      fmt::print("{}", man_page(app, BREAKAWAY_VERSION));
    } else {
      exit_code = help(app, asked->topic);
    }
  });
}

}  // namespace breakaway::cli
