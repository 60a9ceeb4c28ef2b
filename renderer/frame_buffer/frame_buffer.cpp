#include "renderer/frame_buffer/frame_buffer.hpp"

#include <algorithm>
#include <array>

#include "renderer/frame_buffer/atomic_float.hpp"
#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/frame_buffer/gamma.hpp"
#include "renderer/frame_buffer/spinlock.hpp"

namespace irt {
namespace {

template <class Buffer>
std::unique_ptr<FrameBuffer> make(std::uint32_t width, std::uint32_t height) {
  return std::make_unique<Buffer>(width, height);
}

constexpr std::array entries{
    FrameBufferEntry{"fixed-point", "integer fetch-and-add: wait-free, the same bits in any order",
                     make<FixedPointFrameBuffer>},
    FrameBufferEntry{"atomic-float", "compare-and-swap on floats: lock-free",
                     make<AtomicFloatFrameBuffer>},
    FrameBufferEntry{"spinlock", "floats behind one spinlock, the thesis' (3.2)",
                     make<SpinlockFrameBuffer>},
};

}  // namespace

std::span<const FrameBufferEntry> frame_buffers() {
  return entries;
}

std::uint64_t fnv1a(std::span<const std::uint8_t> bytes, std::uint64_t state) {
  for (const std::uint8_t byte : bytes) state = (state ^ byte) * 0x100'0000'01b3u;
  return state;
}

Image FrameBuffer::image() const {
  Image image{width_, height_, std::vector<std::uint8_t>(std::size_t{pixels()} * 3)};
  constexpr std::uint32_t at_once = 64;
  for (std::uint32_t first = 0; first < pixels(); first += at_once) {
    const std::uint32_t count = std::min(at_once, pixels() - first);
    alignas(64) float linear[3 * at_once];
    sums(first, count, linear);
    to_bytes(linear, std::size_t{3} * count, &image.rgb[std::size_t{3} * first]);
  }
  return image;
}

std::uint64_t FrameBuffer::hash() const {
  return fnv1a(image().rgb);
}

std::uint64_t FixedPointFrameBuffer::hash() const {
  std::uint64_t state = fnv1a({});
  for (const Words& words : words_) {
    for (const auto* word : {&words.red, &words.green, &words.blue}) {
      const std::uint64_t value = word->load(std::memory_order_relaxed);
      std::array<std::uint8_t, 8> bytes{};
      for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
      }
      state = fnv1a(bytes, state);
    }
  }
  return state;
}

}  // namespace irt
