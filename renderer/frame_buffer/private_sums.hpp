/// The frame buffer without a shared word: every thread has sums of its own, which meet when the
/// picture is read.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "renderer/frame_buffer/fixed_point.hpp"
#include "renderer/frame_buffer/quantize.hpp"

namespace irt {

/// When to use: always, unless the contention of a shared frame buffer is what is asked about. An
/// add costs a fraction of `FixedPointFrameBuffer`'s, and threads do not disturb each other.
///
/// Memory: 24 bytes per pixel and thread, of which only strips that the thread adds to are touched.
///
/// How it works: with its first add in a frame a thread takes an array of sums, its own of the
/// frame before if there is one. With its first add to a strip of pixels it sets the strip's sums
/// to zero and puts itself on the strip's list, so that reading and clearing take as long as there
/// is to read, however many threads there are. Sums are integers: nobody can tell who added what.
class PrivateSumsFrameBuffer final : public ExactFrameBuffer {
 public:
  PrivateSumsFrameBuffer(std::uint32_t width, std::uint32_t height)
      : ExactFrameBuffer(width, height),
        frame_(new_frame()),
        strips_((std::size_t{width} * height + strip - 1) / strip) {}

  /// Wait-free but for a thread's first add of a frame, which takes a mutex. A thread's first add
  /// to a strip makes one exchange.
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
    for (std::uint32_t which = 0; which < strips_.size(); ++which) {
      for_each_in(which, [which](Sums& sums) { sums.close(which); });
      strips_[which].store(0, std::memory_order_relaxed);  // nobody adds
    }
    frame_ = new_frame();
  }

 private:
  static constexpr std::uint32_t strip = 16;  ///< pixels; a tile of primary rays is as wide

  /// Per strip of pixels: 1 + the number of the sums that came last, 0 if there are none yet.
  using Strips = std::vector<std::atomic<std::uint32_t>>;

  // One thread's sums. No two share a cache line.
  class alignas(128) Sums {
   public:
    Sums(std::uint32_t number, Strips& strips)
        : number_(number),
          strips_(strips),
          sums_(std::make_unique_for_overwrite<FixedPointSum[]>(strips.size() * strip)),
          others_(strips.size()) {}

    void add(std::uint32_t pixel, const FixedPointSum& more) {
      if (others_[pixel / strip] == 0) open(pixel / strip);
      sums_[pixel] += more;
    }
    const FixedPointSum& operator[](std::uint32_t pixel) const { return sums_[pixel]; }
    void close(std::uint32_t which) { others_[which] = 0; }
    /// What stood in `Strips` before: the rest of the list.
    [[nodiscard]] std::uint32_t others(std::uint32_t which) const { return others_[which] - 1; }

    std::thread::id owner;
    std::uint64_t frame = 0;  ///< the last one that the owner has added to

   private:
    void open(std::uint32_t which) {
      std::fill_n(&sums_[std::size_t{which} * strip], strip, FixedPointSum{});
      // Relaxed: lists are walked only after the barrier that ends the frame.
      others_[which] = strips_[which].exchange(number_ + 1, std::memory_order_relaxed) + 1;
    }

    std::uint32_t number_;
    Strips& strips_;
    std::unique_ptr<FixedPointSum[]> sums_;
    std::vector<std::uint32_t> others_;  ///< 1 + `others`; 0 where the strip's sums do not count
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
    if (free == nullptr) {
      const auto number = static_cast<std::uint32_t>(all_.size());
      free = all_.emplace_back(std::make_unique<Sums>(number, strips_)).get();
    }
    free->owner = me;
    free->frame = frame_;
    return *free;
  }

  void fetch(std::uint32_t first, std::uint32_t count, FixedPointSum* sums) const override {
    std::fill_n(sums, count, FixedPointSum{});
    const std::uint32_t end = first + count;
    for (std::uint32_t which = first / strip; which * strip < end; ++which) {
      const std::uint32_t begin = std::max(first, which * strip);
      const std::uint32_t stop = std::min(end, (which + 1) * strip);
      for_each_in(which, [=](const Sums& one) {
        for (std::uint32_t pixel = begin; pixel < stop; ++pixel) sums[pixel - first] += one[pixel];
      });
    }
  }

  /// Calls `body` with the sums of every thread that has added to a strip. No add runs meanwhile:
  /// the barrier that ends the frame orders every exchange before the relaxed load.
  template <class Body>
  void for_each_in(std::uint32_t which, Body body) const {
    for (std::uint32_t next = strips_[which].load(std::memory_order_relaxed); next != 0;) {
      Sums& sums = *all_[next - 1];
      next = sums.others(which);
      body(sums);
    }
  }

  std::uint64_t frame_;  ///< written between frames, by whoever starts the next one
  Strips strips_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Sums>> all_;  ///< guarded by `mutex_` while adds run
};

}  // namespace irt
