#include "stress/running/program.hpp"

#include <cstdio>
#include <exception>
#include <fmt/format.h>
#include <new>

namespace irt {

int run_program(std::string_view name, const std::function<int()>& work, std::string_view smaller) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "{}: out of memory{}{}\n", name, smaller.empty() ? "" : "; use ", smaller);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
  }
  return 2;
}

}  // namespace irt
