/// The frame buffer without a shared word: every thread has sums of its own, which meet when the
/// picture is read.
#pragma once

#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/frame_buffer/quantize.hpp"

namespace irt {

/// When to use: always, unless the contention of a shared frame buffer is what is asked about. An
/// add is a tenth of the work of `FixedPointFrameBuffer`'s, and threads do not disturb each other.
///
/// Memory: 24 bytes per pixel and thread, of which only strips that the thread adds to are touched.
///
/// How it works: with its first add in a frame a thread takes an array of sums, its own of the
/// frame before if there is one. A strip of pixels is set to zero with the first add to it, so that
/// `clear` costs next to nothing and reading costs as much as there is to read. Sums are integers,
/// so nobody can tell who added what.
class PrivateSumsFrameBuffer final : public ExactFrameBuffer {
 public:
  PrivateSumsFrameBuffer(std::uint32_t width, std::uint32_t height)
      : ExactFrameBuffer(width, height), frame_(new_frame()) {}

  /// Wait-free but for a thread's first add of a frame, which takes a mutex.
  void add(std::uint32_t pixel, Vec3 value) override {
    mine().add(pixel, FixedPointSum::of(value));
  }

  using FrameBuffer::add;
  void add(std::uint32_t count, const std::uint32_t* pixel, const float* red, const float* green,
           const float* blue) override {
    Sums& sums = mine();
    std::uint64_t channel[3][at_once];
    for (std::uint32_t done = 0; done < count; done += at_once) {
      const std::uint32_t now = std::min(at_once, count - done);
      quantize(red + done, now, channel[0]);
      quantize(green + done, now, channel[1]);
      quantize(blue + done, now, channel[2]);
      for (std::uint32_t i = 0; i < now; ++i) {
        sums.add(pixel[done + i],
                 FixedPointSum::of_integers(channel[0][i], channel[1][i], channel[2][i]));
      }
    }
  }

  void clear() override {
    for (const auto& sums : all_) sums->clear();
    frame_ = new_frame();
  }

 private:
  static constexpr std::uint32_t strip = 16;  ///< pixels; a tile of primary rays is as wide

  // One thread's sums. No two share a cache line.
  class alignas(128) Sums {
   public:
    explicit Sums(std::uint32_t pixels)
        : sums_(std::make_unique_for_overwrite<FixedPointSum[]>(padded(pixels))),
          used_(padded(pixels) / strip) {}

    void add(std::uint32_t pixel, const FixedPointSum& more) {
      if (used_[pixel / strip] == 0) open(pixel / strip);
      sums_[pixel] += more;
    }
    void clear() { used_.assign(used_.size(), 0); }
    /// Adds what is here to `sums`, those of `count` pixels from `first` on.
    void add_to(std::uint32_t first, std::uint32_t count, FixedPointSum* sums) const {
      for (std::uint32_t i = 0; i < count; ++i) {
        if (used_[(first + i) / strip] != 0) sums[i] += sums_[first + i];
      }
    }

    std::thread::id owner;
    std::uint64_t frame = 0;  ///< the last one that the owner has added to

   private:
    static std::size_t padded(std::uint32_t pixels) {
      return (std::size_t{pixels} + strip - 1) / strip * strip;
    }
    void open(std::uint32_t which) {
      std::fill_n(&sums_[std::size_t{which} * strip], strip, FixedPointSum{});
      used_[which] = 1;
    }

    std::unique_ptr<FixedPointSum[]> sums_;
    std::vector<std::uint8_t> used_;  ///< per strip: 1 if its sums count
  };

  /// A number that no other frame of any buffer has.
  static std::uint64_t new_frame() {
    static std::atomic<std::uint64_t> last{0};
    return last.fetch_add(1, std::memory_order_relaxed) + 1;  // relaxed: by atomicity alone
  }

  Sums& mine() {
    thread_local struct {
      std::uint64_t frame = 0;
      Sums* sums = nullptr;
    } known;
    if (known.frame != frame_) known = {frame_, &take()};
    return *known.sums;
  }

  /// The calling thread's sums in this frame.
  Sums& take() {
    const std::scoped_lock lock(mutex_);
    const std::thread::id me = std::this_thread::get_id();
    Sums* free = nullptr;
    for (const auto& sums : all_) {
      if (sums->owner == me) {
        sums->frame = frame_;
        return *sums;
      }
      if (sums->frame != frame_) free = sums.get();
    }
    if (free == nullptr) free = all_.emplace_back(std::make_unique<Sums>(pixels())).get();
    free->owner = me;
    free->frame = frame_;
    return *free;
  }

  void fetch(std::uint32_t first, std::uint32_t count, FixedPointSum* sums) const override {
    std::fill_n(sums, count, FixedPointSum{});
    for (const auto& one : all_) one->add_to(first, count, sums);
  }

  std::uint64_t frame_;  ///< written between frames, by whoever starts the next one
  std::mutex mutex_;
  std::vector<std::unique_ptr<Sums>> all_;  ///< guarded by `mutex_` while adds run
};

}  // namespace irt
