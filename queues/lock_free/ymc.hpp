/// YMC: a list of segments whose cells are given out by fetch-and-add, and requests that others
/// finish (Yang and Mellor-Crummey 2016, "A Wait-free Queue as Fast as Fetch-and-Add", PPoPP).
///
/// When to use: many cores push and pop at once, and no thread may be kept from its task by others.
/// When not: memory must stay bounded although a thread is stopped; there are many small queues,
/// for a segment has up to 16 KiB; elements may be 0.
///
/// Ordering: FIFO in real time. Progress: wait-free in the paper's sense, apart from the allocator:
/// others cannot make an operation repeat its work for ever, but one that falls behind walks over
/// the segments they have filled since. Memory: segments of 1,024 cells of 16 bytes, each used
/// once; what was left is freed some segments later, unless a thread stands still in an operation:
/// from its segment on all are kept. So it is wait-free only where memory has no end. Unbounded. A
/// smaller `capacity` makes smaller segments.
///
/// How it works: a push takes a ticket at the tail and writes its word to that cell of an endless
/// array, of which segments are allocated as they are reached. A pop takes a ticket at the head;
/// where its cell is empty it spoils it, so that the push with this ticket fails and takes another.
/// Who has failed too often writes down a request:
/// - A push goes on taking tickets. At each cell that it spoils a pop looks for a request of a
///   pusher, its workers in turn, and reserves the cell for it; whoever comes to a reserved cell
///   claims the request for this cell, which only one cell gets, and writes the word there.
/// - A pop's request is searched for, from its ticket on, by all who help: a cell whose word nobody
///   has taken, or at which the queue was empty, is a candidate. One candidate at a time is
///   announced in the request, and all try to take that one for it before they go on searching.
///   Each pop that got an element helps one other worker, in turn.
///
/// Segments are freed in their order. An operation says from which segment on it reads, before it
/// takes its ticket. Who needs a new segment moves `oldest_` as far as all those, head and tail
/// allow, and frees what was left by then if they still do: what somebody takes from another's
/// request in between is seen at the second look.
///
/// What differs from the paper, and why:
/// - A pop answers *empty* without a ticket where the head has reached the tail. In the paper each
///   look at an empty queue spoils a cell: polling uses memory up, and the next push has to pass
///   all those cells.
/// - A claim that fails reads request and word anew. Otherwise the cell may be taken for a dead one
///   while its pusher is about to write to it, or the word of an earlier request is written.
/// - A push does not look whether the cell is spoilt before it claims it. Whoever spoils it sees
///   the reservation.
/// - Segments are freed up to the tail, too. In the paper only heads count, and when pops are ahead
///   a push may find its segment gone. Workers' pointers into the list are their own, and
///   out-of-date ones are told by the number of the oldest segment.
/// - Requests are named by their worker's number, so that a cell has 16 bytes. Tickets that follow
///   each other have cells in different cache lines, where the paper has one cell in each line.
/// - A worker has its next segment in hand before it takes a ticket, and takes a request back when
///   there is no memory, so that no cell is left without the visit that it needs.
#pragma once

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "queues/cache_line.hpp"
#include "queues/word.hpp"
#include "queues/work_queue.hpp"

namespace irt {

/// The algorithm. Who has failed `patience` times more than once asks for help.
template <class T, unsigned patience>
class WaitFreeSegments {
 public:
  static constexpr Claims claims{.ordering = Ordering::fifo_real_time,
                                 .push = Progress::wait_free,
                                 .pop = Progress::wait_free,
                                 .reclamation = Reclamation::epochs,
                                 .all_ones_reserved = true,
                                 .reserved = {0}};

  /// Of the longest segment.
  static constexpr std::size_t most_cells = 1024;

  WaitFreeSegments(unsigned workers, std::size_t capacity)
      // A cell for each worker at least: then no ticket is ahead of the last segment by more than
      // the next one, since of as many tickets one has been at its cell.
      : bits_(static_cast<unsigned>(std::bit_width(
            std::max<std::size_t>({2, workers, std::min(capacity, most_cells)}) - 1))),
        workers_(workers),
        first_(new Segment(bits_)),
        oldest_(first_) {
    for (unsigned i = 0; i < workers; ++i) {
      workers_[i].number = i + 1;
      workers_[i].head = workers_[i].tail = {first_, 0};
    }
  }
  WaitFreeSegments(const WaitFreeSegments&) = delete;
  WaitFreeSegments& operator=(const WaitFreeSegments&) = delete;

  ~WaitFreeSegments() {
    // relaxed: destruction is single-threaded
    while (first_ != nullptr)
      delete std::exchange(first_, first_->next.load(std::memory_order_relaxed));
  }

  /// Adds `task` at the back. Wait-free. Always true.
  bool push(unsigned worker, T task) {
    const std::uint64_t word = word_of(task);
    Worker& me = workers_[worker];
    const Holding holding(me, me.tail);
    std::uint64_t ticket = 0;
    for (unsigned tries = 0; tries <= patience; ++tries) {
      if (!draw(me, tail_, me.tail, ticket)) throw std::bad_alloc();
      std::uint64_t seen = nothing;
      // (1) release: pairs with (12), (13), (21), (41) and (49), so that the task is read as
      // written. relaxed on failure: the cell is spoilt
      if (find(me, me.tail, ticket)
              .word.compare_exchange_strong(seen, word, std::memory_order_release,
                                            std::memory_order_relaxed))
        return true;
    }
    push_slowly(me, word, ticket);
    return true;
  }

  /// Takes the oldest task; false if there is none. Wait-free.
  bool pop(unsigned worker, T& task) {
    // (2) acquire: pairs with the one in (4), so that the head has been here when the tail is read
    const std::uint64_t head = head_.load(std::memory_order_acquire);
    // (3) seq_cst: pairs with (4) and (10); an old tail would let us answer *empty* too early. (11)
    // does the same
    if (tail_.load(std::memory_order_seq_cst) <= head) return false;
    Worker& me = workers_[worker];
    const Holding holding(me, me.head);
    std::uint64_t ticket = 0;
    std::uint64_t word = spoilt;
    for (unsigned tries = 0; tries <= patience && word == spoilt; ++tries) {
      if (!draw(me, head_, me.head, ticket)) throw std::bad_alloc();
      word = take(me, ticket);
    }
    if (word == spoilt) word = pop_slowly(me, ticket);
    if (word == nothing) return false;
    help_pop(me, workers_[me.helps_pop]);
    me.helps_pop = next(me.helps_pop);
    task = element_of<T>(word);
    return true;
  }

 private:
  // Words that are no elements: of a cell that can be filled by its ticket's push, and of one that
  // can be filled for a request only. Also what a cell has for a pop: nothing in the whole queue,
  // or nothing here.
  static constexpr std::uint64_t nothing = 0;
  static constexpr std::uint64_t spoilt = ~std::uint64_t{0};

  // For whom a cell is reserved, or by whom its word was taken, besides workers' numbers: nobody
  // yet; no request, for good.
  static constexpr unsigned nobody = 0;
  static constexpr unsigned closed = ~0U;

  struct Cell {
    std::atomic<std::uint64_t> word{nothing};
    std::atomic<unsigned> pusher{nobody};
    std::atomic<unsigned> popper{nobody};
  };

  struct Segment {
    explicit Segment(unsigned bits) : cells(std::size_t{1} << bits) {}
    std::uint64_t id = 0;
    std::atomic<Segment*> next{nullptr};
    std::vector<Cell> cells;
  };

  // A way into the list. Its segment may be gone if its id is less than `oldest_id_`.
  struct Cursor {
    Segment* segment = nullptr;
    std::uint64_t id = 0;
  };

  // The state of a request: the place of a cell, and whether it is still to be done.
  static std::uint64_t pending(std::uint64_t place) { return place << 1U | 1U; }
  static std::uint64_t done(std::uint64_t place) { return place << 1U; }
  static bool is_pending(std::uint64_t state) { return (state & 1U) != 0; }
  static std::uint64_t place_of(std::uint64_t state) { return state >> 1U; }

  // Pending with the ticket after which it came, done with the cell that was claimed for it.
  struct PushRequest {
    std::atomic<std::uint64_t> word{nothing};
    std::atomic<std::uint64_t> state{0};
  };

  // Pending with its ticket, then with the candidate that is announced.
  struct PopRequest {
    std::atomic<std::uint64_t> ticket{0};
    std::atomic<Segment*> segment{nullptr};  // of the ticket
    std::atomic<std::uint64_t> state{0};
  };

  static constexpr std::uint64_t idle = ~std::uint64_t{0};

  struct alignas(cache_line_pair) Worker {
    std::atomic<std::uint64_t> holds{idle};  // from which segment on it reads
    PushRequest push;
    PopRequest pop;
    // The worker's own.
    unsigned number = nobody;
    unsigned helps_push = 0;
    unsigned helps_pop = 0;
    std::uint64_t helps_ticket = 0;  // of the request that could not be helped last time; or 0
    Cursor head;
    Cursor tail;
    std::unique_ptr<Segment> spare;
  };

  // While it lives a worker reads the list, from `from` on.
  class Holding {
   public:
    Holding(Worker& me, const Cursor& from) : me_(me) {
      // (5) release: pairs with (7), so that what was read before this visit may be freed. (4)
      // makes it seen, and (16) finds nothing older
      me_.holds.store(from.id, std::memory_order_release);
    }
    Holding(const Holding&) = delete;
    Holding& operator=(const Holding&) = delete;
    // (6) release: pairs with (7)
    ~Holding() { me_.holds.store(idle, std::memory_order_release); }

   private:
    Worker& me_;
  };

  [[nodiscard]] unsigned next(unsigned worker) const {
    return worker + 1 == workers_.size() ? 0 : worker + 1;
  }

  // Takes a ticket, and sees to it that `cursor` is in the list; false if there is no memory.
  bool draw(Worker& me, std::atomic<std::uint64_t>& counter, Cursor& cursor,
            std::uint64_t& ticket) {
    if (!reserve(me)) return false;
    // (4) seq_cst: of the tail pairs with (3) and (11), so that a pop that begins later sees that
    // there was a push, and with (35) and (46). Of the head pairs with (2). Of both pairs with (8):
    // who frees segments sees (5), or this worker sees in (9) how far they are gone
    ticket = counter.fetch_add(1, std::memory_order_seq_cst);
    // (9) seq_cst: pairs with (18), and stands after (4)
    if (cursor.id < oldest_id_.load(std::memory_order_seq_cst)) {
      // (16) acquire: pairs with (17). This segment is at or behind those that (5) holds
      Segment* oldest = oldest_.load(std::memory_order_acquire);
      cursor = {oldest, oldest->id};
    }
    return true;
  }

  // Has a new segment in hand; false if there is no memory.
  bool reserve(Worker& me) {
    if (me.spare != nullptr) return true;
    reclaim();
    try {
      me.spare = std::make_unique<Segment>(bits_);
    } catch (const std::bad_alloc&) {
      return false;
    }
    return true;
  }

  // The cell with that number, at which `cursor` is then.
  Cell& find(Worker& me, Cursor& cursor, std::uint64_t place) {
    while (cursor.id < place >> bits_) {
      // (14) acquire: pairs with (15), so that the segment is whole
      Segment* following = cursor.segment->next.load(std::memory_order_acquire);
      if (following == nullptr) {
        me.spare->id = cursor.id + 1;
        // (15) release: pairs with (14), (22) and (45), so that the segment is whole
        // (45) acquire: on failure; pairs with (15)
        if (cursor.segment->next.compare_exchange_strong(
                following, me.spare.get(), std::memory_order_release, std::memory_order_acquire))
          following = me.spare.release();
      }
      cursor = {following, cursor.id + 1};
    }
    // Four cells share a line of 64 bytes, so tickets that follow each other are four cells apart.
    const std::uint64_t mask = cursor.segment->cells.size() - 1;
    const std::uint64_t at = place & mask;
    return cursor.segment->cells[(4 * at + (at >> (std::max(bits_, 2U) - 2))) & mask];
  }

  // Frees segments that were left. No more than two, so that nobody has to do it all.
  void reclaim() {
    // (19) acquire: pairs with (20)
    if (reclaiming_.exchange(true, std::memory_order_acquire)) return;
    // (8) seq_cst: twice; pairs with (4)
    std::uint64_t needed =
        std::min(head_.load(std::memory_order_seq_cst), tail_.load(std::memory_order_seq_cst)) >>
        bits_;
    // (7) seq_cst: as an acquire pairs with (5) and (6); and with (23)
    for (const Worker& worker : workers_)
      needed = std::min(needed, worker.holds.load(std::memory_order_seq_cst));
    // relaxed, twice: written under this lock; and the next one was seen when `oldest_` came by
    Segment* oldest = oldest_.load(std::memory_order_relaxed);
    for (int i = 0; i < 2 && first_->id < std::min(needed, oldest->id); ++i)
      delete std::exchange(first_, first_->next.load(std::memory_order_relaxed));
    for (int i = 0; i < 2 && oldest->id < needed; ++i) {
      // (22) acquire: pairs with (15)
      Segment* following = oldest->next.load(std::memory_order_acquire);
      if (following == nullptr) break;
      oldest = following;
    }
    // (17) release: pairs with (16)
    oldest_.store(oldest, std::memory_order_release);
    // (18) seq_cst: pairs with (9)
    oldest_id_.store(oldest->id, std::memory_order_seq_cst);
    // (20) release: pairs with (19)
    reclaiming_.store(false, std::memory_order_release);
  }

  // Pushes with the help of those who pop.
  void push_slowly(Worker& me, std::uint64_t word, std::uint64_t ticket) {
    // (24) release: pairs with (25) and (47), so that who reads this word sees the one before in
    // its cell
    me.push.word.store(word, std::memory_order_release);
    // (26) seq_cst: pairs with (27), so that whoever spoils a cell from now on sees the request; as
    // a release with (28) and (33)
    me.push.state.store(pending(ticket), std::memory_order_seq_cst);
    Cursor cursor = me.tail;
    std::uint64_t state = 0;
    // (29) acquire: pairs with (30), so that the segment of the cell is seen
    while (is_pending(state = me.push.state.load(std::memory_order_acquire))) {
      std::uint64_t place = 0;
      if (draw(me, tail_, cursor, place)) {
        unsigned pusher = nobody;
        // (31) release: pairs with (32), (36) and (48), so that the request is seen. relaxed on
        // failure: the cell is somebody else's
        if (find(me, cursor, place)
                .pusher.compare_exchange_strong(pusher, me.number, std::memory_order_release,
                                                std::memory_order_relaxed))
          claim(me.push, state, place);
        // relaxed, twice: nobody needs to know; and on failure (29) reads it again
      } else if (me.push.state.compare_exchange_strong(state, done(0), std::memory_order_relaxed,
                                                       std::memory_order_relaxed)) {
        throw std::bad_alloc();
      }
    }
    commit(find(me, me.tail, place_of(state)), word, place_of(state));
  }

  // The request is done at `place`, if it is still as in `state`, which is how it is found else.
  static bool claim(PushRequest& request, std::uint64_t& state, std::uint64_t place) {
    // (30) release: pairs with (29) and (33)
    // (33) acquire: on failure; pairs with (26) and (30), so that the word is that of the request
    return request.state.compare_exchange_strong(state, done(place), std::memory_order_release,
                                                 std::memory_order_acquire);
  }

  void commit(Cell& cell, std::uint64_t word, std::uint64_t place) {
    advance(tail_, place + 1);
    // (34) release: pairs with (12), (13), (21), (41) and (49), so that the task is read as written
    cell.word.store(word, std::memory_order_release);
  }

  // Who takes a ticket later gets one from `least` on.
  static void advance(std::atomic<std::uint64_t>& counter, std::uint64_t least) {
    // (35) acquire: pairs with (4) and (10), so that who sees this operation returned sees a
    // counter as late as this
    std::uint64_t count = counter.load(std::memory_order_acquire);
    // (10) seq_cst: pairs with (3), (11), (35) and (46)
    // (46) acquire: on failure; pairs with (4) and (10), as the load above
    while (count < least &&
           !counter.compare_exchange_strong(count, least, std::memory_order_seq_cst,
                                            std::memory_order_acquire)) {
    }
  }

  // A pop is at `cell`: its word; or `nothing` if the queue is empty; or `spoilt`, if no word will
  // be here.
  std::uint64_t visit(Worker& me, Cell& cell, std::uint64_t place) {
    std::uint64_t word = await(cell, place);
    // (13) acquire: pairs with (1) and (34), on failure; on success none is needed, but it must not
    // be weaker
    if (word == nothing && cell.word.compare_exchange_strong(
                               word, spoilt, std::memory_order_acquire, std::memory_order_acquire))
      word = spoilt;
    if (word != spoilt) return word;
    // (32) acquire: pairs with (31) and (36)
    unsigned pusher = cell.pusher.load(std::memory_order_acquire);
    if (pusher == nobody) pusher = reserve_for_request(me, cell, place);
    // (11) seq_cst: pairs with (4) and (10), as does (3); here and below
    const auto is_empty = [&] { return tail_.load(std::memory_order_seq_cst) <= place; };
    if (pusher == closed) return is_empty() ? nothing : spoilt;
    PushRequest& request = workers_[pusher - 1].push;
    // (28) acquire: pairs with (26)
    std::uint64_t state = request.state.load(std::memory_order_acquire);
    // (25) acquire: pairs with (24); here and below
    word = request.word.load(std::memory_order_acquire);
    // relaxed, here and below: where the cell has a word, (21) reads it
    const auto is_spoilt = [&] { return cell.word.load(std::memory_order_relaxed) == spoilt; };
    if (place_of(state) > place) {
      // It came too late for this cell, or has got another one.
      if (is_spoilt() && is_empty()) return nothing;
    } else if (is_pending(state) && claim(request, state, place)) {
      commit(cell, word, place);
    } else {
      // (47) acquire: pairs with (24)
      word = request.word.load(std::memory_order_acquire);
      // While the cell is spoilt the pusher has not gone on to another request.
      if (state == done(place) && is_spoilt()) commit(cell, word, place);
    }
    // (21) acquire: pairs with (1) and (34)
    return cell.word.load(std::memory_order_acquire);
  }

  // Reserves a spoilt cell for the request whose turn it is, or for none; says for which it is.
  unsigned reserve_for_request(Worker& me, Cell& cell, std::uint64_t place) {
    // (27) seq_cst: pairs with (26)
    const auto state_of = [&](unsigned worker) {
      return workers_[worker].push.state.load(std::memory_order_seq_cst);
    };
    std::uint64_t state = state_of(me.helps_push);
    if (me.helps_ticket != 0 && me.helps_ticket != place_of(state)) {
      me.helps_push = next(me.helps_push);
      state = state_of(me.helps_push);
    }
    const bool helps = is_pending(state) && place_of(state) <= place;
    const unsigned wanted = helps ? workers_[me.helps_push].number : closed;
    unsigned pusher = nobody;
    // (36) acq_rel: pairs with (31), (32) and (48), and with itself
    // (48) acquire: on failure; pairs with (31) and (36)
    const bool is_ours = cell.pusher.compare_exchange_strong(
        pusher, wanted, std::memory_order_acq_rel, std::memory_order_acquire);
    // Stays with a request until it is served: in the end all who pop help the same one.
    if (helps && !is_ours) {
      me.helps_ticket = place_of(state);
    } else {
      me.helps_ticket = 0;
      me.helps_push = next(me.helps_push);
    }
    return is_ours ? wanted : pusher;
  }

  // The word of `cell`, if possible when the push with this ticket has been there.
  std::uint64_t await(const Cell& cell, std::uint64_t place) {
    // (12) acquire: pairs with (1) and (34)
    std::uint64_t word = cell.word.load(std::memory_order_acquire);
    // relaxed: it saves a wait
    if (word != nothing || tail_.load(std::memory_order_relaxed) <= place) return word;
    for (std::size_t looks = 1 + (std::size_t{1} << bits_) / 64; looks > 0 && word == nothing;
         --looks) {
      pause();
      // (49) acquire: pairs with (1) and (34)
      word = cell.word.load(std::memory_order_acquire);
    }
    return word;
  }

  // What the pop with `ticket` gets: a word, or else what visit() says.
  std::uint64_t take(Worker& me, std::uint64_t ticket) {
    Cell& cell = find(me, me.head, ticket);
    const std::uint64_t word = visit(me, cell, ticket);
    if (word == nothing || word == spoilt) return word;
    unsigned popper = nobody;
    // relaxed, twice: it decides who has the word, and the word is known
    return cell.popper.compare_exchange_strong(popper, closed, std::memory_order_relaxed,
                                               std::memory_order_relaxed)
               ? word
               : spoilt;
  }

  // Pops with the help of those who pop.
  std::uint64_t pop_slowly(Worker& me, std::uint64_t ticket) {
    // relaxed, twice: (37) publishes them
    me.pop.ticket.store(ticket, std::memory_order_relaxed);
    me.pop.segment.store(me.head.segment, std::memory_order_relaxed);
    // (37) seq_cst: pairs with (38), so that whoever has popped from now on sees the request
    me.pop.state.store(pending(ticket), std::memory_order_seq_cst);
    std::uint64_t state = 0;
    while (is_pending(state = help_pop(me, me)))
      // (39) seq_cst: pairs with (42). relaxed on failure: help_pop() reads it again
      if (me.pop.state.compare_exchange_strong(state, done(ticket), std::memory_order_seq_cst,
                                               std::memory_order_relaxed))
        throw std::bad_alloc();
    const std::uint64_t place = place_of(state);
    // (41) acquire: pairs with (1) and (34)
    const std::uint64_t word = find(me, me.head, place).word.load(std::memory_order_acquire);
    advance(head_, place + 1);
    return word == spoilt ? nothing : word;
  }

  // Sees to it that the request of `other` is done, if there is one. The state in which it was
  // found: still pending only if there is no memory, and then what was announced is lost.
  std::uint64_t help_pop(Worker& me, Worker& other) {
    PopRequest& request = other.pop;
    // (38) seq_cst: pairs with (37)
    std::uint64_t state = request.state.load(std::memory_order_seq_cst);
    // relaxed, here and below: (38) and (42) acquire what belongs to the state
    const std::uint64_t ticket = request.ticket.load(std::memory_order_relaxed);
    if (!is_pending(state) || place_of(state) < ticket) return state;
    Cursor announced{request.segment.load(std::memory_order_relaxed), ticket >> bits_};
    // relaxed: this worker's own
    if (announced.id < me.holds.load(std::memory_order_relaxed))
      // (23) seq_cst: pairs with (7), and stands before (42). If the request is still pending in
      // the next line, `other` has held the segment until now, so that nobody frees it who has not
      // looked here afterwards
      me.holds.store(announced.id, std::memory_order_seq_cst);
    // (42) seq_cst: pairs with (39) and (40), after (23); as an acquire with (43), so that the
    // announced cell's segment is seen; here and below
    state = request.state.load(std::memory_order_seq_cst);
    Cursor cursor = announced;
    std::uint64_t prior = ticket;  // no candidate from here on is known to be lost
    std::uint64_t searched = ticket;
    std::uint64_t candidate = 0;
    // relaxed: as above
    while (is_pending(state) && request.ticket.load(std::memory_order_relaxed) == ticket) {
      if (state == pending(prior)) {
        if (candidate == 0) {
          if (!reserve(me)) return state;
          Cell& cell = find(me, cursor, ++searched);
          const std::uint64_t word = visit(me, cell, searched);
          // relaxed: (44) decides
          if (word == nothing ||
              (word != spoilt && cell.popper.load(std::memory_order_relaxed) == nobody))
            candidate = searched;
        }
        // (43) release: pairs with (42). relaxed on failure: (42) reads it again
        if (candidate != 0)
          request.state.compare_exchange_strong(
              state, pending(candidate), std::memory_order_release, std::memory_order_relaxed);
        state = request.state.load(std::memory_order_seq_cst);
        continue;
      }
      prior = place_of(state);
      Cell& cell = find(me, announced, prior);
      unsigned popper = nobody;
      // relaxed: (42) has acquired what who announced it has seen here
      // (44) relaxed, twice: it decides who has the word, whatever is seen elsewhere
      if (cell.word.load(std::memory_order_relaxed) == spoilt ||
          cell.popper.compare_exchange_strong(popper, other.number, std::memory_order_relaxed,
                                              std::memory_order_relaxed) ||
          popper == other.number) {
        // (40) seq_cst: pairs with (42). relaxed on failure: another thread has done it
        request.state.compare_exchange_strong(state, done(prior), std::memory_order_seq_cst,
                                              std::memory_order_relaxed);
        return done(prior);
      }
      if (prior >= searched) {
        candidate = 0;
        searched = prior;
      }
    }
    return state;
  }

  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  const unsigned bits_;
  std::vector<Worker> workers_;
  Segment* first_;  // that is not freed yet; under `reclaiming_`, as what is written to `oldest_`
  std::atomic<Segment*> oldest_;
  std::atomic<std::uint64_t> oldest_id_{0};
  std::atomic<bool> reclaiming_{false};
  // From 1 on: no ticket is 0.
  alignas(cache_line_pair) std::atomic<std::uint64_t> head_{1};
  alignas(cache_line_pair) std::atomic<std::uint64_t> tail_{1};
};

/// The paper's WF-10.
template <class T>
class Ymc : public WaitFreeSegments<T, 10> {
 public:
  static constexpr std::string_view summary =
      "YMC (WF-10): segments, fetch-and-add, help after eleven failures";
  using WaitFreeSegments<T, 10>::WaitFreeSegments;
};

/// The paper's WF-0.
template <class T>
class ImpatientYmc : public WaitFreeSegments<T, 0> {
 public:
  static constexpr std::string_view summary =
      "YMC (WF-0): segments, fetch-and-add, help after one failure";
  using WaitFreeSegments<T, 0>::WaitFreeSegments;
};

}  // namespace irt
