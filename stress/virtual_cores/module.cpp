#include <algorithm>
#include <cstring>
#include <cxxabi.h>
#include <dlfcn.h>
#include <elf.h>
#include <link.h>
#include <memory>
#include <stdexcept>

#include "stress/virtual_cores/harmless.hpp"
#include "stress/virtual_cores/internal.hpp"

// Memory is known by its address here.
// NOLINTBEGIN(performance-no-int-to-ptr)

namespace irt::virtual_cores {

namespace {

// The module's variables that live in memory it may write after loading: .data and .bss, without
// what the loader has made read-only.
using Globals = Range;

int find_globals(dl_phdr_info* info, std::size_t, void* result) {
  auto& [offset, globals] = *static_cast<std::pair<std::uintptr_t, Globals>*>(result);
  if (info->dlpi_addr != offset) return 0;
  std::uintptr_t read_only_end = 0;
  for (unsigned i = 0; i < info->dlpi_phnum; ++i) {
    const ElfW(Phdr)& header = info->dlpi_phdr[i];
    const std::uintptr_t begin = offset + header.p_vaddr;
    if (header.p_type == PT_LOAD && (header.p_flags & PF_X) != 0)
      add_code(begin, begin + header.p_memsz);
    if (header.p_type == PT_GNU_RELRO) read_only_end = (begin + header.p_memsz + 4095) & ~4095UL;
    if (header.p_type == PT_LOAD && (header.p_flags & PF_W) != 0)
      globals = {begin, begin + header.p_memsz};
  }
  globals.begin = std::min(std::max(globals.begin, read_only_end), globals.end);
  return 1;
}

std::string demangled(const char* name) {
  int status = 0;
  const std::unique_ptr<char, void (*)(void*)> text(
      abi::__cxa_demangle(name, nullptr, nullptr, &status), std::free);
  return status == 0 ? text.get() : name;
}

}  // namespace

struct Module::State {
  std::string file;
  void* handle = nullptr;
  const link_map* map = nullptr;
  Globals globals{};
  std::vector<char> initial{};
};

Module::Module(const std::string& file) : state_(new State{.file = file}) {
  state_->handle = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (state_->handle == nullptr)
    throw std::runtime_error(std::string("virtual cores: ") + dlerror());
  dlinfo(state_->handle, RTLD_DI_LINKMAP, &state_->map);
  std::pair<std::uintptr_t, Globals> search{state_->map->l_addr, {}};
  dl_iterate_phdr(find_globals, &search);
  state_->globals = search.second;
  const auto* begin = reinterpret_cast<const char*>(state_->globals.begin);
  state_->initial.assign(begin, begin + (state_->globals.end - state_->globals.begin));
}

Module::~Module() {
  dlclose(state_->handle);
}

void* Module::find(const std::string& symbol) const {
  void* address = dlsym(state_->handle, symbol.c_str());
  if (address == nullptr)
    throw std::runtime_error("virtual cores: " + state_->file + " exports no \"" + symbol +
                             "\"; make it with irt_virtual_module()");
  return address;
}

void Module::reset_globals() {
  std::memcpy(reinterpret_cast<void*>(state_->globals.begin), state_->initial.data(),
              state_->initial.size());
}

bool Module::owns_global(std::uintptr_t address) const {
  return address >= state_->globals.begin && address < state_->globals.end;
}

Range Module::globals() const {
  return state_->globals;
}

std::vector<std::string> Module::unseen_calls() const {
  const ElfW(Sym)* symbols = nullptr;
  const char* names = nullptr;
  for (const ElfW(Dyn)* entry = state_->map->l_ld; entry->d_tag != DT_NULL; ++entry) {
    if (entry->d_tag == DT_SYMTAB) symbols = reinterpret_cast<const ElfW(Sym)*>(entry->d_un.d_ptr);
    if (entry->d_tag == DT_STRTAB) names = reinterpret_cast<const char*>(entry->d_un.d_ptr);
  }
  std::vector<std::string> result;
  if (symbols == nullptr || names == nullptr) return result;
  // The string table follows the symbol table in every linker's output; there is no other count.
  const std::size_t count =
      static_cast<std::size_t>(names - reinterpret_cast<const char*>(symbols)) / sizeof(ElfW(Sym));
  for (std::size_t i = 1; i < count; ++i) {
    const char* name = names + symbols[i].st_name;
    if (symbols[i].st_shndx == SHN_UNDEF && !is_harmless(name)) result.push_back(demangled(name));
  }
  std::sort(result.begin(), result.end());
  return result;
}

const std::string& Module::file() const {
  return state_->file;
}
std::uintptr_t Module::load_offset() const {
  return state_->map->l_addr;
}

}  // namespace irt::virtual_cores
// NOLINTEND(performance-no-int-to-ptr)
