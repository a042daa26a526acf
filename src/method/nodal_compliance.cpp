#include "rbvi/method/nodal.hpp"

#include <algorithm>

namespace rbvi {

NodalCompliance::NodalCompliance(SparseMatrix average)
    : average_(std::move(average)), moved_(average_.cols(), average_.rows()),
      blocks_(average_.rows(), average_.rows()), known_(average_.rows() / 2, false) {
  const SparseMatrix pattern = average_.cwiseAbs(), met = pattern * pattern.transpose();
  neighbours_.resize(known_.size());
  for (Index row = 0; row < met.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(met, row); entry; ++entry)
      neighbours_[row / 2].push_back(entry.col() / 2);
  for (std::vector<Index> &nodes : neighbours_) {
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  }
}

void NodalCompliance::require(const std::vector<Index> &nodes, Compliance &compliance) {
  std::vector<Index> fresh, dofs;
  for (const Index node : nodes) {
    if (known_[node]) continue;
    fresh.push_back(node);
    for (Index row = 2 * node; row < 2 * node + 2; ++row)
      for (SparseMatrix::InnerIterator entry(average_, row); entry; ++entry)
        dofs.push_back(entry.col());
  }
  if (fresh.empty()) return;
  compliance.require(dofs);
  for (const Index node : fresh) {
    known_[node] = true;
    for (Index row = 2 * node; row < 2 * node + 2; ++row) {
      moved_.col(row).setZero();
      for (SparseMatrix::InnerIterator entry(average_, row); entry; ++entry)
        moved_.col(row) += entry.value() * compliance.column(entry.col());
      blocks_.col(row).noalias() = average_ * moved_.col(row);
    }
  }
}

} // namespace rbvi
