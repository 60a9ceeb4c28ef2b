/// Runs a test program built by irt_add_check(): its `main` natively, and what it gives to
/// irt::explore() under the checker.
#pragma once

#include <string>
#include <vector>

namespace irt::checker {

/// Returns what its main returns. `arguments` are those of main, with its name.
int run_tests(const std::string& module, const std::vector<std::string>& arguments);

}  // namespace irt::checker
