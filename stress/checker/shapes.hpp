/// Clients of a queue, written as shapes.
///
///     EE|D|DE      three threads: two pushes; a pop; a pop and a push
///     EE:D|D       before the threads start, two pushes are made
///     (ED)*40|D    a part that is made forty times; parts may be nested, and `x` is as good as `*`
///
///     E  push the next element           R  the renderer's task: pop one; if there was one, push
///     D  pop                                two, once per letter
///     EE|D|D;E     after the threads and before the queue is emptied, one more is pushed
///
///     S  signal: whoever waits ...       W  ... goes on, and everything before S happens before
///
///     T  the renderer's worker on a queue whose pop waits for tasks and answers "empty" when the
///        frame is over: pop until then; a task of the prologue pushes two
///
///     F  fill: push until it is full, at most twice its capacity; then pop one and push again
///
///     EE|DD@2      the queue is made for two elements
///     E:D|D+250    before anything else one worker has made 250 pairs of a push and a pop
///
///     P  pop_wait                        L  pop_wait with a deadline, which may pass at any time
///     C  close                           a queue may be closed before, while and after others wait
///
///     B  push_bulk of two elements       G  pop_bulk of up to two
///
///     E|D;X        at the end of an epilogue: the queue is destroyed as it is, not emptied first
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "queues/work_queue.hpp"

namespace irt::checker {

struct Shape {
  std::string prologue;
  std::vector<std::string> threads;
  std::string epilogue;
  std::size_t capacity = 0;  ///< of the queue, in elements; 0: left open
  std::uint64_t age = 0;     ///< pairs of a push and a pop before anything else

  friend bool operator==(const Shape&, const Shape&) = default;
};

/// Steps that push, and that pop.
inline constexpr std::string_view pushing = "ERTFB";
inline constexpr std::string_view popping = "DRTFPLG";

/// Steps of one thread, of the prologue or of the epilogue: at most so many.
inline constexpr std::size_t most_steps = 10'000;

/// Repeated parts are written out. Throws std::invalid_argument that says what is wrong with
/// `text`.
Shape parse_shape(std::string_view text);
/// The shortest way to write it that this file knows; `parse_shape` makes the same shape of it.
std::string to_string(const Shape& shape);

/// Whether the queue is destroyed with what is inside at the end.
bool leaves_inside(const Shape& shape);

/// How many elements the prologue has inside at once, as far as E and D say.
std::size_t most_held(const Shape& shape);

/// How many elements it pushes, as far as E, R and B say.
std::size_t pushes_of(const Shape& shape);

/// Whether a waiting pop may be left without an element although the queue does all it should: too
/// few are pushed for certain, and nobody closes the queue for certain. A push may find no place in
/// a queue with `places` of them; 0: there are enough. The shape's own capacity comes first.
bool may_starve(const Shape& shape, const Claims& claims, std::size_t places = 0);

/// Whether somebody closes the queue before anybody waits, so that a push may find no place.
bool closes_for_certain(const Shape& shape);

/// Pushes and pops, and steps that make several, in all words.
std::size_t calls_of(const Shape& shape);

/// Whether a queue with these claims may be used so: by no more workers than it is for, and by one
/// producer or consumer at a time where it is for one. Who is done may hand that role over, by a
/// signal that the other one waits for.
bool allows(const Claims& claims, const Shape& shape);

/// The first step of `shape` that calls a method which a queue with these does not have, and which
/// method that is, as a clause; empty if there is none.
std::string obstacle(const Methods& methods, const Shape& shape);

}  // namespace irt::checker
