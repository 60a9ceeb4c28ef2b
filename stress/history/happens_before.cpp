#include "stress/history/happens_before.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace irt::stress {

HappensBefore::HappensBefore(const Matching& matching) : matching_(&matching) {
  for (const auto& log : matching.history().logs) rows_.push_back({&log, {}, {}, {}});
  rows_.push_back({&matching.history().drain, {}, {}, {}});
  for (Row& row : rows_) {
    row.clocks.resize(row.log->size() * rows_.size());
    row.earliest_push.resize((row.log->size() + 1) * rows_.size(), no_push);
  }
  run();
  if (cycle_) return;
  note_earliest();
  for (Row& row : rows_) {
    row.counts.emplace_back();
    for (const Operation& operation : *row.log) {
      Count count = row.counts.back();
      count.pushes += operation.kind == Kind::push ? 1 : 0;
      count.refused += operation.kind == Kind::full ? 1 : 0;
      count.pops += operation.kind == Kind::pop ? 1 : 0;
      count.empties += operation.kind == Kind::empty ? 1 : 0;
      row.counts.push_back(count);
    }
  }
}

void HappensBefore::run() {
  const std::size_t width = rows_.size();
  const std::size_t workers = width - 1;
  std::vector<std::size_t> at(width, 0);
  std::vector<std::vector<Tick>> now(width, std::vector<Tick>(width, 0));

  const auto join = [&](std::vector<Tick>& into, const Tick* from) {
    for (std::size_t i = 0; i < width; ++i) into[i] = std::max(into[i], from[i]);
  };
  const auto step = [&](std::size_t row) {
    now[row][row] = static_cast<Tick>(++at[row]);
    std::ranges::copy(
        now[row], rows_[row].clocks.begin() + static_cast<std::ptrdiff_t>((at[row] - 1) * width));
  };
  // Runs a row until it must wait for a barrier or for another row's push.
  const auto advance = [&](std::size_t row) {
    const auto& log = *rows_[row].log;
    const std::size_t start = at[row];
    while (at[row] < log.size()) {
      const Operation& operation = log[at[row]];
      if (operation.kind == Kind::meet) break;
      if (operation.kind == Kind::pop) {
        if (const Life* life = matching_->find(operation.value); life != nullptr) {
          const unsigned producer = producer_of(operation.value);
          const auto pushed = static_cast<std::size_t>(life->push - rows_[producer].log->data());
          if (pushed >= at[producer]) break;
          join(now[row], clock(producer, pushed));
        }
      }
      step(row);
    }
    return at[row] != start;
  };
  const auto pass_barrier = [&] {
    std::vector<Tick> all(width, 0);
    bool any = false;
    for (std::size_t row = 0; row < workers; ++row) {
      const auto& log = *rows_[row].log;
      if (at[row] < log.size() && log[at[row]].kind != Kind::meet) return false;
      any = any || at[row] < log.size();
      join(all, now[row].data());
    }
    for (std::size_t row = 0; any && row < workers; ++row) {
      if (at[row] == rows_[row].log->size()) continue;
      join(now[row], all.data());
      step(row);
    }
    return any;
  };

  for (bool moved = true; moved;) {
    moved = false;
    for (std::size_t row = 0; row < workers; ++row) moved = advance(row) || moved;
    moved = moved || pass_barrier();
  }
  for (std::size_t row = 0; row < workers; ++row) {
    if (at[row] == rows_[row].log->size()) continue;
    const Operation& pop = (*rows_[row].log)[at[row]];
    cycle_ = Violation{
        Pattern::fresh,
        fmt::format("{} was popped by what had to happen before its push", element_name(pop.value)),
        {matching_->culprit(pop)}};
    return;
  }
  for (std::size_t row = 0; row < workers; ++row) join(now[workers], now[row].data());
  advance(workers);
}

void HappensBefore::note_earliest() {
  const std::size_t width = rows_.size();
  for (Row& row : rows_) {
    for (std::size_t i = row.log->size(); i-- > 0;) {
      Tick* here = &row.earliest_push[i * width];
      std::copy_n(here + width, width, here);
      const Operation& operation = (*row.log)[i];
      if (operation.kind != Kind::pop) continue;
      if (const Life* life = matching_->find(operation.value); life != nullptr) {
        const unsigned producer = producer_of(operation.value);
        const auto tick = static_cast<Tick>(life->push - rows_[producer].log->data() + 1);
        here[producer] = std::min(here[producer], tick);
      }
    }
  }
}

std::size_t HappensBefore::first_after(std::size_t row, std::size_t of, std::size_t index) const {
  if (row == of) return index + 1;
  std::size_t low = 0;
  std::size_t high = rows_[row].log->size();
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    if (clock(row, middle)[of] > index) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

std::optional<HappensBefore::Position> HappensBefore::later_pop(
    const Tick* past, Position at, std::optional<std::size_t> producer,
    std::optional<std::size_t> only_row) const {
  const std::size_t width = rows_.size();
  for (std::size_t row = 0; row < width; ++row) {
    if (only_row && row != *only_row) continue;
    const std::size_t first = first_after(row, at.row, at.index);
    const Tick* earliest = &rows_[row].earliest_push[first * width];
    for (std::size_t pusher = 0; pusher + 1 < width; ++pusher) {
      if (earliest[pusher] > past[pusher] || (producer && pusher != *producer)) continue;
      for (std::size_t i = first;; ++i) {
        const Operation& pop = (*rows_[row].log)[i];
        if (pop.kind != Kind::pop || producer_of(pop.value) != pusher) continue;
        const Life* life = matching_->find(pop.value);
        if (life == nullptr) continue;
        if (life->push - rows_[pusher].log->data() < past[pusher]) return Position{row, i};
      }
    }
  }
  return std::nullopt;
}

std::optional<Violation> HappensBefore::judge_order(bool same_producer) const {
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const auto& log = *rows_[row].log;
    for (std::size_t i = 0; i < log.size(); ++i) {
      if (log[i].kind != Kind::pop) continue;
      const Life* b = matching_->find(log[i].value);
      if (b == nullptr) continue;
      const std::size_t producer = producer_of(log[i].value);
      const auto pushed = static_cast<std::size_t>(b->push - rows_[producer].log->data());
      const auto at = later_pop(clock(producer, pushed), {row, i},
                                same_producer ? std::optional(producer) : std::nullopt, {});
      if (!at || operation(*at).value == log[i].value) continue;
      const Operation& late = operation(*at);
      return Violation{
          Pattern::order,
          fmt::format("{} left before {}, which had been pushed earlier by {}",
                      element_name(log[i].value), element_name(late.value),
                      same_producer ? "the same producer" : "happens-before"),
          {matching_->culprit(*matching_->find(late.value)->push), matching_->culprit(*b->push),
           matching_->culprit(log[i]), matching_->culprit(late)}};
    }
  }
  return std::nullopt;
}

HappensBefore::Range HappensBefore::concurrent(std::size_t row, Position at) const {
  const std::size_t from = clock(at.row, at.index)[row];
  return {from, std::max(from, first_after(row, at.row, at.index))};
}

InFlight HappensBefore::around(Position at) const {
  InFlight result;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    if (row == at.row) continue;
    const Range range = concurrent(row, at);
    const Count& before = rows_[row].counts[range.from];
    const Count& until = rows_[row].counts[range.to];
    result.pushes += static_cast<std::uint64_t>(until.pushes - before.pushes);
    result.pops += static_cast<std::uint64_t>(until.pops - before.pops);
    result.refused += until.refused > before.refused ? 1 : 0;
  }
  return result;
}

bool HappensBefore::has_doubtful_empty(Position at, Position pop) const {
  const Element e = operation(pop).value;
  const std::size_t producer = producer_of(e);
  const auto pushed =
      static_cast<std::size_t>(matching_->find(e)->push - rows_[producer].log->data());
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    if (row == at.row) continue;
    const auto empties = [&counts = rows_[row].counts](std::size_t from, std::size_t to) {
      return from < to ? counts[to].empties - counts[from].empties : 0;
    };
    const Range range = concurrent(row, at);
    const std::size_t from = std::max(range.from, first_after(row, producer, pushed));
    const std::size_t to = std::min<std::size_t>(range.to, clock(pop.row, pop.index)[row]);
    if (empties(range.from, range.to) > empties(from, to)) return true;
  }
  return false;
}

bool HappensBefore::found_again(Position at, Position pop) const {
  // Who drained what is not written down.
  if (pop.row != at.row || at.row + 1 == rows_.size()) return false;
  for (std::size_t row = 0; row < rows_.size(); ++row)
    if (row != at.row && clock(at.row, at.index)[row] < first_after(row, pop.row, pop.index))
      return false;
  return true;
}

HappensBefore::Empties HappensBefore::judge_empties(const Specification& specification) const {
  Empties result;
  const bool own_only = specification.empty() == Answer::this_worker;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const auto& log = *rows_[row].log;
    for (std::size_t i = 0; i < log.size(); ++i) {
      if (log[i].kind != Kind::empty) continue;
      ++result.all;
      const Position at{row, i};
      std::optional<Position> pop = later_pop(clock(row, i), at, {}, {});
      if (!pop) continue;
      ++result.refuted;
      if (result.first) continue;
      if (own_only) pop = later_pop(clock(row, i), at, {}, row);
      if (!pop) continue;
      InFlight in_flight = around(at);
      in_flight.doubtful_empty = has_doubtful_empty(at, *pop);
      if (specification.allows_empty(in_flight, found_again(at, *pop))) continue;
      const Element e = operation(*pop).value;
      result.first =
          Violation{Pattern::witness,
                    fmt::format("pop answered empty between push and pop of {} by happens-before{}",
                                element_name(e),
                                specification.empty() == Answer::calls_in_flight
                                    ? ", and no call in flight explains it"
                                    : ""),
                    {matching_->culprit(*matching_->find(e)->push), matching_->culprit(log[i]),
                     matching_->culprit(operation(*pop))}};
    }
  }
  return result;
}

std::optional<Violation> HappensBefore::judge_full(const Specification& specification) const {
  for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
    const auto& log = *rows_[row].log;
    for (std::size_t i = 0; i < log.size(); ++i) {
      if (log[i].kind != Kind::full) continue;
      const Position at{row, i};
      std::int64_t most = 0;
      for (std::size_t other = 0; other + 1 < rows_.size(); ++other) {
        const Range range = concurrent(other, at);
        most += rows_[other].counts[range.to].pushes - rows_[other].counts[range.from].pops;
      }
      // Fewer than none were pushed twice, which is another finding.
      const auto inside = static_cast<std::uint64_t>(std::max<std::int64_t>(most, 0));
      if (specification.allows_full(inside, around(at))) continue;
      return Violation{
          Pattern::full,
          fmt::format("push answered full although by happens-before at most {} of {} places can "
                      "have been taken",
                      inside, specification.capacity()),
          {matching_->culprit(log[i])}};
    }
  }
  return std::nullopt;
}

}  // namespace irt::stress
