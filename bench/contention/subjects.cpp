#include "bench/contention/subjects.hpp"

#include <dlfcn.h>
#include <filesystem>
#include <map>
#include <string>

#include "bench/contention/job.hpp"
#include "queues/modules.hpp"

namespace irt::contention {

namespace {

/// The contention module `file`, which stays open: its code is in use until the process ends.
SubjectMaker open_module(const std::filesystem::path& file) {
  void* object = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (object == nullptr) throw RegistryError(std::string(dlerror()));
  const auto* module = static_cast<const SubjectModule*>(dlsym(object, "irt_contention"));
  constexpr SubjectModule own;
  if (module == nullptr || module->abi_version != own.abi_version ||
      module->seat_bytes != own.seat_bytes || module->table_bytes != own.table_bytes)
    throw RegistryError(file.string() + ": built for another version of irt; build it again");
  return module->make;
}

/// Of plug-ins, by the queue's name, which is that of its file.
std::map<std::string, SubjectMaker, std::less<>>& opened_modules() {
  static std::map<std::string, SubjectMaker, std::less<>> opened;
  return opened;
}

/// Accepts everything and always has the same to give.
class Nothing {
 public:
  Nothing(unsigned /*workers*/, std::size_t /*capacity*/) {}
  bool push(unsigned /*worker*/, std::uint64_t element) {
    asm volatile("" : : "r"(element));
    return true;
  }
  bool pop(unsigned /*worker*/, std::uint64_t& element) {
    asm volatile("" : "=r"(element));
    return true;
  }
};

}  // namespace

void open_subject_module(const std::filesystem::path& plugin) {
  const auto file = module_beside(std::filesystem::absolute(plugin), ModuleKind::contention);
  if (std::filesystem::exists(file)) opened_modules()[plugin.stem()] = open_module(file);
}

SubjectMaker subject_maker(const QueueRegistry& queues, std::string_view name) {
  if (name == no_queue) return maker_of<Nothing>();
  if (is_registered(name, ModuleKind::contention))
    return open_module(module_of_tree(name, ModuleKind::contention));
  const auto module = opened_modules().find(name);
  return module != opened_modules().end() ? module->second : type_erased_maker(queues.at(name));
}

SubjectMaker type_erased_maker(const QueueEntry& entry) {
  return [&entry](unsigned workers, std::size_t capacity, bool two) -> std::unique_ptr<Subject> {
    return std::make_unique<SubjectOf<AnyWorkQueue<std::uint64_t>>>(
        entry.make_word_queue(workers, capacity),
        two ? entry.make_word_queue(workers, capacity) : nullptr);
  };
}

bool type_erased(std::string_view name) {
  return !is_registered(name, ModuleKind::contention) && !opened_modules().contains(name);
}

}  // namespace irt::contention
