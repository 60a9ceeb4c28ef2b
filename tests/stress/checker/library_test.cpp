#include <gtest/gtest.h>

#include "stress/checker/checker.hpp"
#include "stress/checker/report.hpp"
#include "tests/stress/checker/findings.hpp"

namespace irt::checker {
namespace {

class Library : public testing::Test {
 protected:
  virtual_cores::Module module_{IRT_LIBRARY_PROBE};
};

TEST_F(Library, compiled_code_of_the_standard_library_is_seen) {
  unsigned count = 0;
  const auto* programs =
      module_.function<const findings::Program*(unsigned*)>("irt_library_programs")(&count);
  Symbols symbols(module_);
  for (unsigned i = 0; i < count; ++i) {
    const findings::Program& program = programs[i];
    Program checked;
    checked.module = &module_;
    for (const auto thread : program.threads)
      if (thread != nullptr) checked.threads.emplace_back(thread);
    if (program.prepare != nullptr) checked.prepare = program.prepare;
    if (program.finish != nullptr) checked.finish = program.finish;
    Options options{.seconds = 10};
    // Too large for a proof.
    if (program.name == std::string_view("future"))
      options = {.search = Search::pos, .executions = 2000};
    const Result result = check(checked, options);
    EXPECT_EQ(result.finding ? std::string(name_of(result.finding->kind)) : "", program.finding)
        << program.name << ": " << (result.finding ? sentence(*result.finding, symbols) : "");
    EXPECT_TRUE(result.finished || result.finding || options.search != Search::exhaustive)
        << program.name << " was not finished in " << result.executions << " executions";
  }
}

TEST_F(Library, executions_that_differ_are_no_proof_and_no_finding) {
  const auto& program = *module_.function<const findings::Program*()>("irt_foreign_dice")();
  Program checked;
  checked.module = &module_;
  checked.threads = {program.threads[0], program.threads[1]};
  for (const Search search : {Search::exhaustive, Search::bounded, Search::pos}) {
    const Result result = check(checked, {.search = search, .executions = 500, .seconds = 5});
    EXPECT_FALSE(result.finished && search != Search::pos);
    EXPECT_NE(result.incomplete.find("executions differ"), std::string::npos)
        << static_cast<int>(search);
    EXPECT_FALSE(result.finding);
  }
}

// What is left is named; std::exception_ptr counts its users in compiled code.
TEST_F(Library, and_what_is_not_is_named) {
  for (const std::string& call : module_.unseen_calls())
    EXPECT_TRUE(call.find("exception_ptr") != std::string::npos ||
                call.find("rethrow_exception") != std::string::npos ||
                call.find("current_exception") != std::string::npos || call == "lrand48")
        << call;
  EXPECT_FALSE(module_.unseen_calls().empty());
}

}  // namespace
}  // namespace irt::checker
