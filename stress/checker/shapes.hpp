/// Clients of a queue, written as shapes.
///
///     EE|D|DE      three threads: two pushes; a pop; a pop and a push
///     EE:D|D       before the threads start, two pushes are made
///
///     E  push the next element           R  the renderer's task: pop one; if there was one, push
///     D  pop                                two, once per letter
///     EE|D|D;C     after the threads and before the queue is emptied, it is closed
///
///     S  signal: whoever waits ...       W  ... goes on, and everything before S happens before
///
///     T  the renderer's worker on a queue whose pop waits for tasks and answers "empty" when the
///        frame is over: pop until then; a task of the prologue pushes two
///
///     F  fill: push until it is full, at most twice its capacity; then pop one and push again
///
///     EE|DD@2      the queue is made for two elements
///
///     C  close: push `close_word`, for queues whose pop waits until they are closed
#pragma once

#include <cstddef>
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
};

/// Throws std::invalid_argument that says what is wrong with `text`.
Shape parse_shape(std::string_view text);
std::string to_string(const Shape& shape);

/// The shapes that a queue with these claims is tried with, small ones first.
std::vector<std::string> battery(const Claims& claims);

}  // namespace irt::checker
