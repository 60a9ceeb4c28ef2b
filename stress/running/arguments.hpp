/// What every command line refuses.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace irt {

/// Refuses values of nothing, as `--scene ''` or the last of `--queue lock,`, for every option that
/// `command` and its subcommands have by now.
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

}  // namespace irt
