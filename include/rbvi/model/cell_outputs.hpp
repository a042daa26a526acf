// Named outputs apart from contact, of reduced answers: reactions projected onto the primal basis
// where their terms depend on mu by factors alone, the others taken from the cells that they need.
#pragma once

#include "rbvi/model/model.hpp"

#include <functional>
#include <map>

namespace rbvi {

/// What boundaries impose at nodes (nodes x dim), node * components + c; empty where they impose
/// nothing.
Vector imposed_at(const Scene &scene, const FullMu &mu, const Matrix &nodes,
                  const std::vector<int> &imposed_by);

/// Whether the parts of outputs are of outputs, cells, facets and terms that there are.
bool fits(const OutputModel &outputs, const Scene &scene, Index cells);

class CellOutputs {
public:
  /// Of the outputs that are asked for (is_asked). `model` and `scene` must outlive it.
  CellOutputs(const OutputModel &model, const Scene &scene,
              const std::vector<std::string> &only = {});
  /// Values by the number of such an output, of an answer whose coefficients `u` must outlive them.
  std::function<double(int output)> at(const FullMu &mu, const Vector &u) const;

private:
  struct Reaction {
    SeparatedReaction sum;
    Matrix projected; ///< its rows on the primal basis
  };
  const OutputModel &model_;
  const Scene &scene_;
  std::map<int, Reaction> reactions_;
  OutputModel others_; ///< of the other outputs alone
};

} // namespace rbvi
