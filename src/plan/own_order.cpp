// The kernels of the host's own that a stepper has, and the order in which they run.
#include <algorithm>
#include <utility>

#include "plan/own_kernels.h"
#include "plan/own_words.h"

namespace pcphys {
namespace {

/// Whether a must run before b, of one moment.
bool precedes(const OwnKernel& a, const OwnKernel& b) {
  if (std::ranges::find(b.follows, a.name) != b.follows.end()) return true;
  if (std::ranges::find(a.follows, b.name) != a.follows.end()) return false;
  const auto rank = [](const OwnArgument& argument) { return argument.anew() ? 0 : argument.writes() ? 1 : 2; };
  for (const OwnArgument& x : a.arguments)
    for (const OwnArgument& y : b.arguments)
      if (x.of_property() && y.of_property() && x.property == y.property && x.writes() && rank(x) < rank(y)) return true;
  return false;
}
bool same_moment(const OwnKernel& a, const OwnKernel& b) {
  const bool last[] = {a.form == OwnKernel::Form::reduction, b.form == OwnKernel::Form::reduction};
  if (last[0] || last[1]) return last[0] && last[1];
  return a.stage == b.stage && a.after == b.after && a.once_a_step == b.once_a_step;
}

}  // namespace

bool OwnKernels::pairs_of_bodies() const {
  return std::ranges::any_of(kernels_, [](const auto& k) { return k->form == OwnKernel::Form::pair && k->table == Table::body; });
}
double OwnKernels::cutoff() const {
  double largest = 0;
  for (const auto& k : kernels_) largest = std::max(largest, k->cutoff.value_or(0));
  return largest;
}

OwnKernel* OwnKernels::find(std::string_view name) const {
  for (const auto& k : kernels_)
    if (k->name == name) return k.get();
  return nullptr;
}

Status OwnKernels::order(std::vector<std::shared_ptr<OwnKernel>>& out) const {
  std::vector<std::shared_ptr<OwnKernel>> left = kernels_;
  out.clear();
  while (!left.empty()) {
    const auto free = std::ranges::find_if(left, [&](const auto& b) {
      return std::ranges::none_of(left, [&](const auto& a) { return a != b && same_moment(*a, *b) && precedes(*a, *b); });
    });
    if (free == left.end())
      return bad(*left[0], "and " + quoted(left[1]->name) +
                               " each have to run before the other; run one of them at another stage, or say which follows which "
                               "(KernelDef::follows).");
    out.push_back(*free);
    left.erase(free);
  }
  return {};
}

Status OwnKernels::add(std::shared_ptr<OwnKernel> kernel) {
  if (find(kernel->name))
    return Error{ErrorCode::name_taken,
                 "There is a kernel " + quoted(kernel->name) + " already; remove it, or choose another name."};
  for (const auto& other : kernels_) {
    if (!same_moment(*other, *kernel)) continue;
    for (const OwnArgument& a : other->arguments)
      for (const OwnArgument& b : kernel->arguments)
        if (a.anew() && b.anew() && a.property == b.property && !contains(kernel->follows, other->name) &&
            !contains(other->follows, kernel->name))
          return bad(
              *kernel,
              "and " + quoted(other->name) + " both write " + quoted(a.property) +
                  " anew at the same moment; say which follows which (KernelDef::follows), or let one change it (PC_INOUT).");
  }
  kernels_.push_back(std::move(kernel));
  std::vector<std::shared_ptr<OwnKernel>> ordered;
  if (Status ok = order(ordered); !ok) {
    kernels_.pop_back();
    return ok;
  }
  ordered_ = std::move(ordered);
  version_++;
  return {};
}

Status OwnKernels::remove(std::string_view name) {
  const auto it = std::ranges::find_if(kernels_, [&](const auto& k) { return k->name == name; });
  if (it == kernels_.end())
    return Error{ErrorCode::unknown_name, "There is no kernel " + quoted(name) + "; Stepper::add_kernel adds one."};
  kernels_.erase(it);
  (void)order(ordered_);
  version_++;
  return {};
}

void OwnKernels::clear() {
  kernels_.clear();
  ordered_.clear();
  version_++;
}

}  // namespace pcphys
