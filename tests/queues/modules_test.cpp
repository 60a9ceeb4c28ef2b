// Modules of the tree's queues are built when the front door's tool asks for them.

#include "queues/modules.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

namespace irt {
namespace {

TEST(Modules, lie_side_by_side_under_the_names_of_their_queues) {
  for (const char* name : {"lock", "lfree", "faa"}) {
    EXPECT_TRUE(is_registered(name, ModuleKind::plugin)) << name;
    EXPECT_TRUE(is_registered(name, ModuleKind::contention)) << name;
    EXPECT_TRUE(std::filesystem::exists(module_of_tree(name, ModuleKind::plugin))) << name;
  }
  EXPECT_FALSE(is_registered("loc", ModuleKind::plugin));
  EXPECT_FALSE(is_registered("", ModuleKind::plugin));
  EXPECT_EQ(registered_queues(ModuleKind::plugin).front(), "lock");
  EXPECT_EQ(module_beside(module_of_tree("lock", ModuleKind::plugin), ModuleKind::virtual_cores),
            module_of_tree("lock", ModuleKind::virtual_cores));
}

/// A front door that writes down what it was asked for and ends with `code`.
class FrontDoor {
 public:
  explicit FrontDoor(int code) {
    std::ofstream(script_) << "#!/bin/sh\necho \"$*\" >>'" << asked_.string() << "'\nexit " << code
                           << "\n";
    std::filesystem::permissions(script_, std::filesystem::perms::owner_all);
  }
  FrontDoor(const FrontDoor&) = delete;
  FrontDoor& operator=(const FrontDoor&) = delete;
  ~FrontDoor() {
    unsetenv("IRT_FRONT_DOOR");  // NOLINT(concurrency-mt-unsafe)
    std::filesystem::remove_all(folder_);
  }

  /// That process `process` is to take for the one that it has become.
  void opens_to(pid_t process) const {
    const std::string words = std::to_string(process) + " release " + script_.string();
    setenv("IRT_FRONT_DOOR", words.c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }
  [[nodiscard]] std::string asked() const {
    std::ostringstream text;
    text << std::ifstream(asked_).rdbuf();
    return text.str();
  }

 private:
  static std::filesystem::path folder() {
    std::string name = (std::filesystem::path(testing::TempDir()) / "a doorXXXXXX").string();
    return mkdtemp(name.data());
  }
  std::filesystem::path folder_ = folder(), script_ = folder_ / "irt", asked_ = folder_ / "asked";
};

TEST(Modules, are_built_once_each_by_the_program_that_the_front_door_became) {
  const FrontDoor door(0);
  const std::vector<std::string> names{"lock", "no-such-queue", "lfree", "lock"};
  build_modules(names, ModuleKind::plugin);
  door.opens_to(getppid());
  build_modules(names, ModuleKind::plugin);
  EXPECT_EQ(door.asked(), "");
  door.opens_to(getpid());
  build_modules(names, ModuleKind::plugin);
  const std::string expected = "modules release " +
                               module_of_tree("lock", ModuleKind::plugin).string() + " " +
                               module_of_tree("lfree", ModuleKind::plugin).string() + "\n";
  EXPECT_EQ(door.asked(), expected);
  build_modules(names, ModuleKind::plugin);
  EXPECT_EQ(door.asked(), expected);
}

TEST(Modules, that_do_not_compile_end_what_needs_them) {
  const FrontDoor door(1);
  door.opens_to(getpid());
  const std::vector<std::string> names{"mutex"};
  EXPECT_THROW(build_modules(names, ModuleKind::contention), std::runtime_error);
}

}  // namespace
}  // namespace irt
