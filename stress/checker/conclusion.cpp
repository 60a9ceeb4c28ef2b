#include "stress/checker/conclusion.hpp"

#include <algorithm>

namespace irt::checker {

void Conclusion::begin() {
  outcome_ = Outcome::complete;
  finding_.reset();
  out_of_time_ = false;
}

bool Conclusion::knows(const Finding& finding) const {
  return std::ranges::any_of(known_,
                             [&](const Finding& known) { return same_place(known, finding); });
}

void Conclusion::stop(Outcome outcome) {
  outcome_ = outcome;
  cores_.switch_to(virtual_cores::host);
  std::abort();
}

void Conclusion::stop_in_time() {
  if (!deadline_.passed()) return;
  out_of_time_ = true;
  stop(Outcome::cut);
}

void Conclusion::report(FindingKind kind, std::string text, std::vector<const void*> places,
                        std::vector<Moment> moments) {
  finding_ = Finding{kind, std::move(text), std::move(places), std::move(moments)};
  stop(Outcome::found);
}

void Conclusion::give_up(std::string why) {
  note_incomplete(std::move(why));
  stop(Outcome::cut);
}

void Conclusion::give_up_computing(const void* pc, double seconds, std::string why) {
  constexpr double worth_a_word = 0.04;
  if (incomplete_.empty() && seconds > worth_a_word) incomplete_at_ = pc;
  out_of_time_ = deadline_.passed();
  if (out_of_time_) stop(Outcome::cut);
  give_up(std::move(why));
}

void Conclusion::find(Finding finding) {
  finding_ = std::move(finding);
  outcome_ = Outcome::found;
}

void Conclusion::forget_known() {
  if (outcome_ != Outcome::found || !knows(*finding_)) return;
  outcome_ = Outcome::cut;
  note_incomplete("some executions end in what is reported already");
}

}  // namespace irt::checker
