/// What every command line takes and refuses.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace irt {

/// Refuses values of nothing, as `--scene ''`, for every option that `command` and its subcommands
/// have by now.
inline void refuse_empty(CLI::App& command) {
  const CLI::Validator something(
      [](const std::string& value) {
        return value.empty()
                   ? std::string("nothing is given; name a value, or leave the option out")
                   : std::string();
      },
      std::string());
  for (CLI::Option* option : command.get_options()) {
    if (option->get_items_expected_max() > 0) option->check(something);
  }
  for (CLI::App* subcommand : command.get_subcommands({})) refuse_empty(*subcommand);
}

/// Refuses a list with an element of nothing, as `--queue lock,`, which CLI11 would leave out.
/// Throws CLI::ValidationError.
inline void refuse_gap(const std::string& option, const std::string& list) {
  std::string whole;
  std::size_t gap = 0, number = 0;
  for (std::size_t at = 0; at <= list.size(); ++number) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    if (end == at && gap == 0) gap = number + 1;
    if (end != at) whole += (whole.empty() ? "" : ",") + list.substr(at, end - at);
    at = end + 1;
  }
  if (gap == 0 || list.empty()) return;
  throw CLI::ValidationError(option + " " + list,
                             "number " + std::to_string(gap) + " of the list is empty; " +
                                 (whole.empty() ? "name a value, or leave the option out"
                                                : "write " + option + " " + whole));
}

/// The same for every list among `arguments`.
inline void refuse_gaps(CLI::App& app, const std::vector<std::string>& arguments) {
  CLI::App* command = &app;
  std::string list;  // the option whose values follow, if they are lists
  for (const std::string& argument : arguments) {
    const auto inner = command->get_subcommands(
        [&](const CLI::App* each) { return each->get_name() == argument; });
    if (!inner.empty()) {
      command = inner.front();
      list.clear();
      continue;
    }
    if (!argument.starts_with('-')) {
      if (!list.empty()) refuse_gap(list, argument);
      continue;
    }
    const bool is_long = argument.starts_with("--");
    const std::size_t end = std::min(is_long ? argument.find('=') : 2, argument.size());
    const CLI::Option* option = command->get_option_no_throw(argument.substr(0, end));
    const bool takes_lists = option != nullptr && option->get_delimiter() == ',';
    list = takes_lists ? argument.substr(0, end) : std::string();
    if (takes_lists && end != argument.size()) {
      refuse_gap(list, argument.substr(end + (is_long ? 1 : 0)));
    }
  }
}

/// Parses `arguments`, the program's name left out, with all options in place. An exit code where
/// that is all: help was asked for and given, or there is a mistake, which has been told on
/// standard error.
inline std::optional<int> parse(CLI::App& app, const std::vector<std::string>& arguments) {
  refuse_empty(app);
  try {
    refuse_gaps(app, arguments);
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
}
inline std::optional<int> parse(CLI::App& app, int argc, const char* const* argv) {
  return parse(app, std::vector<std::string>(argv + 1, argv + argc));
}

/// Lets `app` tell mistakes in one line, `name` before it, and say no more.
inline void tell_in_one_line(CLI::App& app, const std::string& name) {
  app.failure_message([name](const CLI::App*, const CLI::Error& error) {
    return name + ": " + error.what() + '\n';
  });
}

}  // namespace irt
