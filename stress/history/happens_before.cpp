#include "stress/history/happens_before.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace irt::stress {

HappensBefore::HappensBefore(const Matching& matching) : matching_(&matching) {
  for (const auto& log : matching.history().logs) rows_.push_back({&log, {}, {}});
  rows_.push_back({&matching.history().drain, {}, {}});
  for (Row& row : rows_) {
    row.clocks.resize(row.log->size() * rows_.size());
    row.earliest_push.resize((row.log->size() + 1) * rows_.size(), no_push);
  }
  run();
  if (!cycle_) note_earliest();
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
    std::copy(now[row].begin(), now[row].end(),
              rows_[row].clocks.begin() + static_cast<std::ptrdiff_t>((at[row] - 1) * width));
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

const Operation* HappensBefore::later_pop(const Tick* past, std::size_t row, std::size_t index,
                                          std::optional<std::size_t> only) const {
  const std::size_t width = rows_.size();
  for (std::size_t other = 0; other < width; ++other) {
    const std::size_t first = first_after(other, row, index);
    const Tick* earliest = &rows_[other].earliest_push[first * width];
    for (std::size_t producer = 0; producer + 1 < width; ++producer) {
      if (earliest[producer] > past[producer] || (only && producer != *only)) continue;
      for (const auto* pop = rows_[other].log->data() + first;; ++pop) {
        if (pop->kind != Kind::pop || producer_of(pop->value) != producer) continue;
        const Life* life = matching_->find(pop->value);
        if (life == nullptr) continue;
        if (life->push - rows_[producer].log->data() < past[producer]) return pop;
      }
    }
  }
  return nullptr;
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
      const Operation* late = later_pop(clock(producer, pushed), row, i,
                                        same_producer ? std::optional(producer) : std::nullopt);
      if (late == nullptr || late->value == log[i].value) continue;
      return Violation{
          Pattern::order,
          fmt::format("{} left before {}, which had been pushed earlier by {}",
                      element_name(log[i].value), element_name(late->value),
                      same_producer ? "the same producer" : "happens-before"),
          {matching_->culprit(*matching_->find(late->value)->push), matching_->culprit(*b->push),
           matching_->culprit(log[i]), matching_->culprit(*late)}};
    }
  }
  return std::nullopt;
}

HappensBefore::Empties HappensBefore::judge_empties() const {
  Empties result;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const auto& log = *rows_[row].log;
    for (std::size_t i = 0; i < log.size(); ++i) {
      if (log[i].kind != Kind::empty) continue;
      ++result.all;
      const Operation* pop = later_pop(clock(row, i), row, i, std::nullopt);
      if (pop == nullptr) continue;
      if (result.refuted++ > 0) continue;
      result.first =
          Violation{Pattern::witness,
                    fmt::format("pop answered empty between push and pop of {} by happens-before",
                                element_name(pop->value)),
                    {matching_->culprit(*matching_->find(pop->value)->push),
                     matching_->culprit(log[i]), matching_->culprit(*pop)}};
    }
  }
  return result;
}

std::optional<Violation> HappensBefore::judge_full(std::size_t capacity, bool exact) const {
  // counts[row][i]: how many of the first i operations are pushes, and how many are pops.
  struct Count {
    std::int64_t pushes = 0;
    std::int64_t pops = 0;
  };
  std::vector<std::vector<Count>> counts(rows_.size());
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    counts[row].resize(rows_[row].log->size() + 1);
    for (std::size_t i = 0; i < rows_[row].log->size(); ++i) {
      const Kind kind = (*rows_[row].log)[i].kind;
      counts[row][i + 1] = {counts[row][i].pushes + (kind == Kind::push ? 1 : 0),
                            counts[row][i].pops + (kind == Kind::pop ? 1 : 0)};
    }
  }
  for (std::size_t row = 0; row + 1 < rows_.size(); ++row) {
    const auto& log = *rows_[row].log;
    for (std::size_t i = 0; i < log.size(); ++i) {
      if (log[i].kind != Kind::full) continue;
      std::int64_t most = 0, concurrent_pops = 0;
      for (std::size_t other = 0; other + 1 < rows_.size(); ++other) {
        const Count& before = counts[other][clock(row, i)[other]];
        const Count& not_after =
            counts[other][std::min(first_after(other, row, i), counts[other].size() - 1)];
        most += not_after.pushes - before.pops;
        concurrent_pops += not_after.pops - before.pops;
      }
      if (most >= static_cast<std::int64_t>(capacity)) continue;
      if (!exact && concurrent_pops > 0) continue;
      return Violation{Pattern::full,
                       fmt::format("push answered full although by happens-before at most {} of "
                                   "{} places can have been taken",
                                   most, capacity),
                       {matching_->culprit(log[i])}};
    }
  }
  return std::nullopt;
}

}  // namespace irt::stress
