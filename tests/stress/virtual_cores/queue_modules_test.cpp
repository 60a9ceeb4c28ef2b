// Where the queues on virtual cores are, and what is in them.

#include "stress/virtual_cores/queue_modules.hpp"

#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <stdexcept>

#include "stress/running/usage_error.hpp"

namespace irt::virtual_cores {
namespace {

std::string words(const std::function<void()>& fails) {
  try {
    fails();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

TEST(QueueModules, AreThoseOfTheTree) {
  const QueueModules modules;
  for (const char* name : {"lock", "lfree", "mutex"}) {
    const auto file = modules.find(name);
    ASSERT_TRUE(file) << name;
    const Module module(*file);
    EXPECT_EQ(queue_of(module).name, name);
  }
  EXPECT_FALSE(modules.find("no-such-queue"));
}

TEST(QueueModules, AndThoseOfPluginsBesideThem) {
  QueueModules modules;
  const std::filesystem::path folder = testing::TempDir();
  std::ofstream(folder / "my-own.virtual.so") << "to be read later";
  EXPECT_EQ(modules.add(folder / "my-own.so"), "my-own");
  EXPECT_EQ(*modules.find("my-own"), folder / "my-own.virtual.so");
  EXPECT_NE(words([&] { modules.add(folder / "my-own.so"); }).find("is there already"),
            std::string::npos);
  EXPECT_NE(words([&] { modules.add(folder / "none.so"); }).find("no none.virtual.so beside it"),
            std::string::npos);
  std::ofstream(folder / "lock.virtual.so") << "";
  EXPECT_THROW(modules.add(folder / "lock.so"), UsageError);
}

TEST(QueueModules, AModuleWithoutAQueueSaysSo) {
  const Module module(IRT_PROBE);
  EXPECT_NE(words([&] { queue_of(module); }).find("exports no \"irt_plugin\""), std::string::npos);
}

}  // namespace
}  // namespace irt::virtual_cores
