#include "stress/checker/test_host.hpp"

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <iterator>
#include <pthread.h>
#include <string_view>
#include <unistd.h>
#include <utility>

#include "stress/checker/child.hpp"
#include "stress/checker/include/irt/explore.hpp"
#include "stress/checker/parts.hpp"
#include "stress/checker/program_check.hpp"
#include "stress/checker/result_bytes.hpp"

namespace irt::checker {

namespace {

virtual_cores::Module* tests = nullptr;

/// What an exploration has come to, from the process that made it.
struct Answer {
  std::uint64_t executions = 0;
  bool whole = false;
  std::string wrong;
};

std::string to_bytes(const Answer& answer) {
  Writer writer;
  writer.put(answer.executions);
  writer.put(answer.whole);
  writer.put_all(answer.wrong);
  return std::move(writer.bytes);
}

Answer from_bytes(const std::string& bytes) {
  Reader reader{bytes};
  Answer answer;
  answer.executions = reader.take<std::uint64_t>();
  answer.whole = reader.take<bool>();
  answer.wrong = reader.take_all<std::string>();
  return answer;
}

ProgramSettings settings_of(void (*body)(void*), void* argument, const irt_exploration& how) {
  ProgramSettings settings{.name = "the test"};
  settings.work = [=] { virtual_cores::run_body([=] { body(argument); }); };
  settings.failures = how.failures != nullptr ? how.failures : [] { return 0U; };
  settings.threads = how.threads;
  settings.seconds = how.seconds;
  settings.conduct = {.jobs = processors(), .keep_going = false, .quiet = true, .reports = true};
  settings.options.seed = how.seed;
  if (how.strategy != std::string("auto")) settings.search = search_named(how.strategy);
  return settings;
}

/// What is on the stack of this thread above `frame`.
virtual_cores::Range stack_above(const void* frame) {
  pthread_attr_t attributes;
  void* lowest = nullptr;
  std::size_t size = 0;
  pthread_getattr_np(pthread_self(), &attributes);
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  return {reinterpret_cast<std::uintptr_t>(frame), reinterpret_cast<std::uintptr_t>(lowest) + size};
}

Answer explored(const ProgramSettings& settings, virtual_cores::Range stack) {
  // A framework and the variables of a test are changed by the body, too.
  tests->remember_memory({stack});
  const auto again = [](const std::string& schedule) {
    return "the same command, with IRT_REPLAY='" + schedule + "' before it";
  };
  Answer answer;
  // NOLINTNEXTLINE(concurrency-mt-unsafe)
  if (const char* schedule = std::getenv("IRT_REPLAY")) {
    answer.wrong = replay(*tests, settings, schedule, "");
    if (answer.wrong.empty()) answer.wrong = stale_schedule;
    return answer;
  }
  const ProgramResult result = check_program(*tests, settings, again);
  answer.whole = result.whole;
  for (const SearchResult& search : result.searches) {
    answer.executions += search.result.executions;
    if (search.result.finding) answer.wrong = search.report;
  }
  if (result.found) return answer;
  if (!result.unseen.refused.empty())
    answer.wrong = "it cannot be explored: " + result.unseen.refused;
  else if (result.differs || result.threads <= 1 || answer.executions == 0)
    answer.wrong = verdict(settings, result);
  return answer;
}

/// A framework in `file` whose failed assertions nobody would see; empty if there is none.
std::string unseen_framework(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  constexpr std::pair<std::string_view, std::string_view> known[] = {
      {"_ZN7testing8UnitTest", "GoogleTest"},
      {"_ZN5Catch", "Catch2"},
      {"_ZN7doctest", "doctest"},
      {"_ZN5boost9unit_test", "Boost.Test"}};
  for (const auto& [symbol, framework] : known)
    if (bytes.find(symbol) != std::string::npos) return std::string(framework);
  return "";
}

/// In a process of its own: explorations leave nothing behind for the tests after it.
Answer explored_elsewhere(const ProgramSettings& settings, virtual_cores::Range stack) {
  std::cout.flush();
  std::fflush(nullptr);
  Child child([&](int line) {
    Answer answer;
    try {
      answer = explored(settings, stack);
    } catch (const std::exception& error) {
      answer.wrong = error.what();
    }
    irt::say(line, to_bytes(answer));
  });
  std::string sent;
  char buffer[1 << 16];
  for (ssize_t count = 0; (count = read(child.line(), buffer, sizeof buffer)) != 0;)
    if (count > 0) sent.append(buffer, static_cast<std::size_t>(count));
  child.join("the exploration");
  return from_bytes(sent);
}

}  // namespace

int run_tests(const std::string& file, const std::vector<std::string>& arguments) {
  virtual_cores::Module module(file, virtual_cores::Module::Constructs::with_main);
  tests = &module;
  std::vector<std::string> words = arguments;
  std::vector<char*> names;
  names.reserve(words.size() + 1);
  for (std::string& word : words) names.push_back(word.data());
  names.push_back(nullptr);
  const auto main = module.find_any({"irt_main", "main"});
  const int status = reinterpret_cast<int (*)(int, char**, char**)>(main)(
      static_cast<int>(words.size()), names.data(), environ);
  // What the tests have registered for the end is theirs, and their memory goes with the module.
  std::cout.flush();
  std::fflush(nullptr);
  std::_Exit(status);
}

}  // namespace irt::checker

extern "C" __attribute__((visibility("default"))) void irt_explore(void (*body)(void*),
                                                                   void* argument,
                                                                   const irt_exploration* how,
                                                                   irt_explored* explored) {
  static std::string wrong;
  if (how->failures == nullptr) {
    static const std::string framework =
        irt::checker::unseen_framework(irt::checker::tests->file());
    if (!framework.empty()) {
      wrong = "irt::explore would not see which assertions fail: include " + framework +
              " before irt/explore.hpp";
      *explored = {0, false, wrong.c_str()};
      return;
    }
  }
  const irt::checker::ProgramSettings settings = irt::checker::settings_of(body, argument, *how);
  const irt::checker::Answer answer = irt::checker::explored_elsewhere(
      settings, irt::checker::stack_above(__builtin_frame_address(0)));
  wrong = answer.wrong;
  *explored = {answer.executions, answer.whole, wrong.empty() ? nullptr : wrong.c_str()};
}
