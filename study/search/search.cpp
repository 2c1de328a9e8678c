// SPDX-License-Identifier: MIT
#include "study/search/search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

namespace cuboct::study {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Points that are asked for together. A constant, so that the answer does not depend on the machine.
constexpr size_t kBatch = 16;
// As long as the reference takes more of the budget than this share, a more exact one is looked for.
constexpr double kReferenceShare = 0.25;

double size_of(double error) { return std::isnan(error) ? kInfinity : std::abs(error); }

// Points measured, each once.
class Measured {
 public:
  explicit Measured(const SearchSpace& space) : space_(space) {}

  void want(const std::vector<Notches>& points) {
    std::vector<Notches> fresh;
    for (const Notches& p : points)
      if (!errors_.contains(p) && std::find(fresh.begin(), fresh.end(), p) == fresh.end()) fresh.push_back(p);
    if (fresh.empty()) return;
    const std::vector<double> errors = space_.errors(fresh);
    for (size_t i = 0; i < fresh.size(); ++i) errors_.emplace(fresh[i], errors.at(i));
  }
  double operator()(const Notches& p) {
    want({p});
    return errors_.at(p);
  }
  const std::map<Notches, double>& all() const { return errors_; }

 private:
  const SearchSpace& space_;
  std::map<Notches, double> errors_;
};

// The first `depth` axes are decided, the others stand at the reference.
struct Node {
  double bound = 0;  // no point below this node costs less
  size_t depth = 0;
  Notches at;
  double sum = 0;

  auto order() const { return std::tuple(bound, -static_cast<int64_t>(depth), at); }
  bool operator<(const Node& other) const { return order() < other.order(); }
};

class Search {
 public:
  Search(const SearchSpace& space, double budget)
      : space_(space), budget_(budget), axes_(space.sizes.size()), measured_(space) {}

  SearchResult run() {
    find_reference();
    result_.cost = kInfinity;
    if (size_of(result_.reference_error) <= budget_ && reference_is_no_accident()) descend();
    result_.met = result_.cost < kInfinity;
    if (result_.met)
      explain();
    else
      fail();
    result_.measured = measured_.all().size();
    return result_;
  }

 private:
  Notches moved(Notches p, size_t axis, int by) const {
    p[axis] += by;
    return p;
  }

  std::vector<Notches> one_cheaper(const Notches& p) const {
    std::vector<Notches> points;
    for (size_t a = 0; a < axes_; ++a)
      if (p[a] > 0) points.push_back(moved(p, a, -1));
    return points;
  }

  // The finest settings, unless they take much of the budget: with few bits a very small time step is worse
  // than a small one, as velocities per step become small beside their last place. Then step by step to the
  // more exact neighbour.
  void find_reference() {
    Notches& at = result_.reference;
    for (const int size : space_.sizes) at.push_back(size - 1);
    while (size_of(measured_(at)) > kReferenceShare * budget_) {
      const std::vector<Notches> near = one_cheaper(at);
      measured_.want(near);
      Notches next = at;
      for (const Notches& p : near)
        if (size_of(measured_(p)) < size_of(measured_(next))) next = p;
      if (next == at) break;
      at = next;
    }
    result_.reference_error = measured_(at);
  }

  // A reference that is not the finest point could be a zero between errors of either sign: it counts only if
  // the next finer notch of each axis that was coarsened keeps the budget as well.
  bool reference_is_no_accident() {
    std::vector<Notches> finer;
    for (size_t a = 0; a < axes_; ++a)
      if (result_.reference[a] + 1 < space_.sizes[a]) finer.push_back(moved(result_.reference, a, 1));
    measured_.want(finer);
    result_.accident = std::any_of(finer.begin(), finer.end(),
                                   [&](const Notches& p) { return !(size_of(measured_(p)) <= budget_); });
    return !result_.accident;
  }

  // The least cost below a node, as costs do not fall from notch to notch.
  double bound(const Notches& at, size_t depth, double parent) {
    const double least = cost(cheapest_below(at, depth));
    return std::isnan(least) ? parent : std::max(least, parent);
  }

  static Notches cheapest_below(Notches at, size_t depth) {
    std::fill(at.begin() + static_cast<std::ptrdiff_t>(depth), at.end(), 0);
    return at;
  }

  double cost(const Notches& p) {
    const auto known = costs_.find(p);
    return known != costs_.end() ? known->second : costs_.emplace(p, space_.cost(p)).first->second;
  }

  // Children of several nodes: each walks its next axis from the reference down until the budget breaks.
  // Their bounds are still those of their parents.
  std::vector<Node> children(const std::vector<Node>& nodes) {
    struct Walk {
      const Node* node;
      int next;
      double part = 0;
    };
    std::vector<Node> made;
    std::vector<Walk> walks;
    for (const Node& node : nodes) {
      walks.push_back({&node, node.at[node.depth] - 1});
      made.push_back({node.bound, node.depth + 1, node.at, node.sum});
    }
    const auto over = [](const Walk& walk) { return walk.next < 0; };
    while (std::erase_if(walks, over), !walks.empty()) {
      const size_t ahead = std::max<size_t>(1, kBatch / walks.size());
      std::vector<Notches> wanted;
      for (const Walk& walk : walks)
        for (int n = walk.next; n >= 0 && walk.next - n < static_cast<int>(ahead); --n)
          wanted.push_back(with(walk.node->at, walk.node->depth, n));
      measured_.want(wanted);
      for (Walk& walk : walks)
        for (size_t i = 0; i < ahead && walk.next >= 0; ++i) {
          const Notches at = with(walk.node->at, walk.node->depth, walk.next);
          walk.part = std::max(walk.part, size_of(measured_(at) - measured_(walk.node->at)));
          if (!(walk.node->sum + walk.part <= budget_)) {
            walk.next = -1;
            break;
          }
          made.push_back({walk.node->bound, walk.node->depth + 1, at, walk.node->sum + walk.part});
          --walk.next;
        }
    }
    return made;
  }

  static Notches with(Notches p, size_t axis, int notch) {
    p[axis] = notch;
    return p;
  }

  // Whether the last axis that was decided goes from cheap to dear here.
  void check_order(const Notches& at, size_t depth) {
    const size_t axis = depth - 1;
    if (at[axis] + 1 >= space_.sizes[axis]) return;
    const Notches p = cheapest_below(at, depth);
    if (cost(p) > cost(moved(p, axis, 1))) throw NotchOrder(axis, at[axis]);
  }

  void descend() {
    std::set<Node> open{
        {bound(result_.reference, 0, 0), 0, result_.reference, size_of(result_.reference_error)}};
    if (axes_ == 0) take(*open.begin());
    while (!open.empty() && axes_ > 0) {
      std::vector<Node> next;
      while (!open.empty() && next.size() < kBatch / 2 && open.begin()->bound <= result_.cost)
        next.push_back(open.extract(open.begin()).value());
      if (next.empty()) break;
      for (Node& child : children(next)) {
        child.bound = bound(child.at, child.depth, child.bound);
        check_order(child.at, child.depth);
        if (child.bound > result_.cost) continue;
        if (child.depth == axes_)
          take(child);
        else
          open.insert(child);
      }
    }
  }

  void take(const Node& leaf) {
    const double c = cost(leaf.at);  // nan ranks before nothing
    const auto rank = [](double price, const Notches& p) {
      return std::tuple(price, std::accumulate(p.begin(), p.end(), 0), p);
    };
    if (!(rank(c, leaf.at) < rank(result_.cost, result_.best.at))) return;
    result_.cost = c;
    result_.best.at = leaf.at;
  }

  // The parts of a point, axis by axis, until the budget breaks.
  Spending spending(const Notches& p) {
    Spending s;
    s.at = p;
    s.error = measured_(p);
    s.sum = size_of(result_.reference_error);
    Notches at = result_.reference;
    for (size_t a = 0; a < axes_ && s.sum <= budget_; ++a) {
      std::vector<Notches> way;
      for (int n = at[a] - 1; n >= p[a]; --n) way.push_back(with(at, a, n));
      measured_.want(way);
      double part = 0;
      for (const Notches& q : way) part = std::max(part, size_of(measured_(q) - measured_(at)));
      s.parts.push_back(part);
      s.sum += part;
      at[a] = p[a];
    }
    return s;
  }

  Notches finest_alike(const Notches& p) const { return space_.finest_alike ? space_.finest_alike(p) : p; }

  void explain() {
    const Notches best = finest_alike(result_.best.at);
    result_.best = spending(best);
    measured_.want(one_cheaper(best));
    for (size_t a = 0; a < axes_; ++a)
      if (best[a] > 0 && finest_alike(moved(best, a, -1)) != best)
        result_.cheaper.push_back({a, spending(moved(best, a, -1))});
  }

  // The axis that would have to be finer: what still changes the error is not converged.
  void fail() {
    const Notches& at = result_.reference;
    result_.best.at = at;
    result_.best.error = result_.reference_error;
    result_.best.sum = size_of(result_.reference_error);
    result_.cost = cost(at);
    std::vector<std::pair<size_t, Notches>> near;
    std::vector<Notches> wanted;
    for (size_t a = 0; a < axes_; ++a)
      for (const int by : {-1, 1})
        if (at[a] + by >= 0 && at[a] + by < space_.sizes[a])
          wanted.push_back(near.emplace_back(a, moved(at, a, by)).second);
    measured_.want(wanted);
    for (const auto& [axis, p] : near) {
      const double change = std::abs(size_of(measured_(p)) - size_of(result_.reference_error));
      if (!std::isfinite(change) || (result_.limit >= 0 && change <= result_.limit_change)) continue;
      result_.limit = static_cast<int>(axis);
      result_.limit_change = change;
    }
  }

  const SearchSpace& space_;
  const double budget_;
  const size_t axes_;
  Measured measured_;
  std::map<Notches, double> costs_;
  SearchResult result_;
};

}  // namespace

NotchOrder::NotchOrder(size_t axis_, int notch_)
    : std::runtime_error(fmt::format("notch {} of axis {} costs more than the one after it", notch_, axis_)),
      axis(axis_),
      notch(notch_) {}

SearchResult search(const SearchSpace& space, double budget) { return Search(space, budget).run(); }

}  // namespace cuboct::study
