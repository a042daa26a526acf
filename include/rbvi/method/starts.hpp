// Where a solve starts, told by mu and by what is known at other parameters: what the answer at the
// nearest one leaves, or a fit through those around mu (core/box.hpp). Where starts are warm, from
// the last answer.
#pragma once

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"

#include <optional>
#include <vector>

namespace rbvi {

/// Of a nearby problem; what is empty is that of the body at rest.
struct Start {
  Vector state{}; ///< displacement at the contact dofs, where contact follows it
  Vector x{};     ///< multipliers, as FrictionResult::start
};

/// Parameters at which something is known.
class Neighbours {
public:
  /// `space` must outlive it. `samples`: free parameters x P.
  explicit Neighbours(const ParameterSpace &space, const Matrix &samples = {})
      : space_(space), points_(parts_of_box(space, samples)) {}
  Index count() const { return points_.cols(); } ///< P
  /// The one at the least distance, in parts of the box; -1: there is none.
  Index nearest(const FullMu &mu) const;
  /// local_fit of `values`, a column for each; empty where there are none.
  Vector fit(const Matrix &values, const FullMu &mu) const;

protected:
  void add(const FullMu &mu);
  void clear() { points_.resize(0, 0); }

private:
  const ParameterSpace &space_;
  Matrix points_; ///< as parts of the box
};

/// `Known`: what an answer leaves; Known{}: from rest.
template <class Known> class Starts : public Neighbours {
public:
  explicit Starts(const ParameterSpace &space, const Matrix &samples = {}, bool warm = false)
      : Neighbours(space, samples), known_(count()), warm_(warm) {}

  /// The last answer where starts are warm and there is one, else what `predicted()` returns.
  template <class Predicted> Known at(Predicted &&predicted) const {
    return last_ ? *last_ : predicted();
  }
  void keep(const Known &answer) {
    if (warm_) last_ = answer;
  }

  /// Of the nearest sample k: from_rest(k), asked for once; where that throws failure, and where
  /// there are no samples, rest.
  template <class FromRest> const Known &nearest_from(const FullMu &mu, FromRest &&from_rest) {
    const Index k = nearest(mu);
    if (k < 0) return rest_;
    std::optional<Known> &known = known_[k];
    if (!known) {
      known.emplace();
      try {
        *known = from_rest(k);
      } catch (const Error &) { // has no answer
      }
    }
    return *known;
  }

  /// What was added at the nearest parameter; null: nothing was.
  const Known *nearest_added(const FullMu &mu) const {
    const Index k = nearest(mu);
    return k < 0 ? nullptr : &*known_[k];
  }
  void add(const FullMu &mu, Known answer) {
    Neighbours::add(mu);
    known_.emplace_back(std::move(answer));
  }
  void clear() {
    Neighbours::clear();
    known_.clear();
  }
  /// The fit of a vector of each that was added.
  template <class Part> Vector fit_added(Part &&part, const FullMu &mu) const {
    Matrix values(count() > 0 ? part(*known_[0]).size() : 0, count());
    for (Index k = 0; k < count(); ++k)
      values.col(k) = part(*known_[k]);
    return fit(values, mu);
  }

private:
  std::vector<std::optional<Known>> known_;
  std::optional<Known> last_;
  const bool warm_;
  const Known rest_{};
};

} // namespace rbvi
