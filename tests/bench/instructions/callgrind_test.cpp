#include "bench/instructions/callgrind.hpp"

#include <gtest/gtest.h>
#include <sstream>
#include <stdexcept>

namespace irt::instructions {
namespace {

// As callgrind 3.19 writes it, shortened: costs of calls stand behind `calls=`, zeros at the end of
// a line are left out, a function may come again.
constexpr const char* text = R"(# callgrind format
version: 1
creator: callgrind-3.19.0
positions: line
events: Ir Dr Dw I1mr D1mr Ge

ob=/build/irt-instructions
fl=main.cpp
fn=irt_measured
12 100 10 20
+3 5
cfi=queue.hpp
cfn=Queue::push(unsigned int, unsigned long)
calls=50 30
14 5000 900 800 1 2 50
15 7 1

fl=queue.hpp
fn=Queue::push(unsigned int, unsigned long)
30 4000 800 700 1 2 50
fn=irt_measured
16 3

totals: 4115 811 720 1 2 50
)";

TEST(Callgrind, costs_belong_to_the_function_that_has_them) {
  std::istringstream file(text);
  const std::vector<Function> functions = read_profile(file);
  ASSERT_EQ(functions.size(), 2U);
  EXPECT_EQ(functions[0].name, "Queue::push(unsigned int, unsigned long)");
  EXPECT_EQ(functions[0].own.at("Ir"), 4000U);
  EXPECT_EQ(functions[0].own.at("Ge"), 50U);
  EXPECT_EQ(functions[1].name, "irt_measured");
  EXPECT_EQ(functions[1].own.at("Ir"), 115U);
  EXPECT_EQ(functions[1].own.at("Dr"), 11U);
  EXPECT_EQ(total(functions).at("Ir"), 4115U);
  EXPECT_EQ(total(functions).at("Dw"), 720U);
}

TEST(Callgrind, refuses_what_is_no_profile) {
  for (const char* wrong : {"", "nothing here", "12 100\n", "events: Ir\n12 100\n"}) {
    std::istringstream file(wrong);
    EXPECT_THROW(read_profile(file), std::runtime_error) << wrong;
  }
}

}  // namespace
}  // namespace irt::instructions
