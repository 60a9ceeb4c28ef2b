/// What every command line takes and refuses.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <utility>

namespace irt {

/// Refuses values of nothing, as `--scene ''`, for every option that `command` and its subcommands
/// have by now. CLI11 itself leaves nothings in a list out, as the last of `--queue lock,`.
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

/// Parses `arguments`, which `CLI::App::parse` takes. An exit code where that is all: help was
/// asked for and given, or there is a mistake, which has been told on standard error.
template <class... Arguments>
std::optional<int> parse(CLI::App& app, Arguments&&... arguments) {
  try {
    app.parse(std::forward<Arguments>(arguments)...);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
}

/// Lets `app` tell mistakes in one line, `name` before it, and say no more.
inline void tell_in_one_line(CLI::App& app, const std::string& name) {
  app.failure_message([name](const CLI::App*, const CLI::Error& error) {
    return name + ": " + error.what() + '\n';
  });
}

}  // namespace irt
