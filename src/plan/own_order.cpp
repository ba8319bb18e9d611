// The kernels of the host's own that a stepper has, and the order in which they run.
#include <algorithm>
#include <utility>

#include "plan/own_kernels.h"
#include "plan/own_words.h"

namespace pcphys {
namespace {

using Kernels = std::vector<std::shared_ptr<OwnKernel>>;

/// Whether the host said so, of the two or by way of others.
bool follows(const Kernels& all, const OwnKernel& later, const OwnKernel& earlier) {
  std::vector<const OwnKernel*> reached{&later};  // later ones of it are not looked at yet
  for (std::size_t i = 0; i < reached.size(); i++)
    for (const std::string& name : reached[i]->follows) {
      if (name == earlier.name) return true;
      const auto found = std::ranges::find(all, name, [](const auto& k) -> const std::string& { return k->name; });
      if (found != all.end() && std::ranges::find(reached, found->get()) == reached.end())
        reached.push_back(found->get());
    }
  return false;
}

/// Whether a must run before b, of one moment.
bool precedes(const Kernels& all, const OwnKernel& a, const OwnKernel& b) {
  if (follows(all, b, a)) return true;
  if (follows(all, a, b)) return false;
  const auto rank = [](const OwnArgument& argument) { return argument.anew() ? 0 : argument.writes() ? 1 : 2; };
  for (const OwnArgument& x : a.arguments)
    for (const OwnArgument& y : b.arguments)
      if (x.of_property() && y.of_property() && x.property == y.property && x.writes() && rank(x) < rank(y))
        return true;
  return false;
}
bool same_moment(const OwnKernel& a, const OwnKernel& b) {
  const bool last[] = {a.form == OwnKernel::Form::reduction, b.form == OwnKernel::Form::reduction};
  if (last[0] || last[1]) return last[0] && last[1];
  return a.stage == b.stage && a.after == b.after && a.once_a_step == b.once_a_step;
}

/// One that has to run before b; null: none.
const OwnKernel* before(const Kernels& all, const Kernels& left, const OwnKernel& b) {
  for (const auto& a : left)
    if (a.get() != &b && same_moment(*a, b) && precedes(all, *a, b)) return a.get();
  return nullptr;
}

/// Of kernels that each have one before them: some go in a circle.
Error circle(const Kernels& all, const Kernels& left) {
  std::vector<const OwnKernel*> way;
  const OwnKernel* k = left.front().get();
  while (std::ranges::find(way, k) == way.end()) {
    way.push_back(k);
    k = before(all, left, *k);
  }
  way.erase(way.begin(), std::ranges::find(way, k));
  std::string others;
  for (std::size_t i = 1; i < way.size(); i++) others += "and " + quoted(way[i]->name) + " ";
  return bad(*way.front(), others + "each have to run before the " + (way.size() == 2 ? "other" : "next, in a circle") +
                               "; run one of them at another stage, or say which follows which (KernelDef::follows).");
}

}  // namespace

bool OwnKernels::pairs_of_bodies() const {
  return std::ranges::any_of(kernels_,
                             [](const auto& k) { return k->form == OwnKernel::Form::pair && k->table == Table::body; });
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
  Kernels left = kernels_;
  out.clear();
  while (!left.empty()) {
    const auto free = std::ranges::find_if(left, [&](const auto& b) { return !before(kernels_, left, *b); });
    if (free == left.end()) return circle(kernels_, left);
    out.push_back(*free);
    left.erase(free);
  }
  return {};
}

Status OwnKernels::add(std::shared_ptr<OwnKernel> kernel) {
  if (find(kernel->name))
    return Error{ErrorCode::name_taken,
                 "There is a kernel " + quoted(kernel->name) + " already; remove it, or choose another name."};
  for (const std::string& name : kernel->follows)
    if (!find(name))
      return Error{ErrorCode::unknown_name, "The kernel " + quoted(kernel->name) + " is to follow " + quoted(name) +
                                                ", and there is no such kernel; add that one first."};
  for (const auto& other : kernels_) {
    if (!same_moment(*other, *kernel)) continue;
    for (const OwnArgument& a : other->arguments)
      for (const OwnArgument& b : kernel->arguments)
        if (a.anew() && b.anew() && a.property == b.property && !follows(kernels_, *kernel, *other) &&
            !follows(kernels_, *other, *kernel))
          return bad(*kernel, "and " + quoted(other->name) + " both write " + quoted(a.property) +
                                  " anew at the same moment; say which follows which (KernelDef::follows), or let one "
                                  "change it (PC_INOUT).");
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

void OwnKernels::put_back(const OwnKernels& before) {
  const std::uint64_t changes = version_;  // goes on: plans may be of what was there in between
  *this = before;
  version_ = changes + 1;
}

}  // namespace pcphys
