// The memory resources of <memory_resource> that take from operator new, which is the tenant's
// here, and the one that hands out pieces of buffers. libstdc++ keeps them in compiled code.

#include <algorithm>
#include <atomic>
#include <memory_resource>
#include <new>

// The names are libstdc++'s.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl58-cpp)
namespace std::pmr {

namespace {

class NewAndDelete final : public memory_resource {
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    return ::operator new (bytes, std::align_val_t{alignment});
  }
  void do_deallocate(void* block, std::size_t, std::size_t alignment) override {
    ::operator delete (block, std::align_val_t{alignment});
  }
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

class Nothing final : public memory_resource {
  void* do_allocate(std::size_t, std::size_t) override { throw std::bad_alloc(); }
  void do_deallocate(void*, std::size_t, std::size_t) override {}
  [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override {
    return this == &other;
  }
};

constinit NewAndDelete new_and_delete;
constinit Nothing nothing;
constinit std::atomic<memory_resource*> by_default{&new_and_delete};

}  // namespace

memory_resource::~memory_resource() = default;

memory_resource* new_delete_resource() noexcept {
  return &new_and_delete;
}
memory_resource* null_memory_resource() noexcept {
  return &nothing;
}
memory_resource* get_default_resource() noexcept {
  return by_default.load();
}
memory_resource* set_default_resource(memory_resource* resource) noexcept {
  return by_default.exchange(resource != nullptr ? resource : &new_and_delete);
}

/// Stands at the end of each buffer; the newest one comes first.
class monotonic_buffer_resource::_Chunk {
 public:
  _Chunk* next;
  void* begin;
  std::size_t bytes;  ///< with this
  std::size_t alignment;
};

monotonic_buffer_resource::~monotonic_buffer_resource() {
  release();
}

void monotonic_buffer_resource::_M_new_buffer(std::size_t bytes, std::size_t alignment) {
  alignment = std::max(alignment, alignof(_Chunk));
  bytes = std::max(bytes, _M_next_bufsiz);
  bytes = (bytes + alignof(_Chunk) - 1) / alignof(_Chunk) * alignof(_Chunk);
  void* const buffer = _M_upstream->allocate(bytes + sizeof(_Chunk), alignment);
  _M_head = new (static_cast<char*>(buffer) + bytes)
      _Chunk{_M_head, buffer, bytes + sizeof(_Chunk), alignment};
  _M_current_buf = buffer;
  _M_avail = bytes;
  _M_next_bufsiz = _S_next_bufsize(_M_next_bufsiz);
}

void monotonic_buffer_resource::_M_release_buffers() noexcept {
  while (_M_head != nullptr) {
    const _Chunk chunk = *_M_head;
    _M_head = chunk.next;
    _M_upstream->deallocate(chunk.begin, chunk.bytes, chunk.alignment);
  }
}

}  // namespace std::pmr
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming,cert-dcl58-cpp)
