/// What is the same in every main.
#pragma once

#include <functional>
#include <string_view>

namespace irt {

/// The exit code of `work`, or 2 where it throws: one line on standard error, `name` before it,
/// says why. `smaller` is what would need less memory, for when there is too little.
int run_program(std::string_view name, const std::function<int()>& work,
                std::string_view smaller = {});

}  // namespace irt
