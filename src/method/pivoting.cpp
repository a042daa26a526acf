#include "pivoting.hpp"

#include "rbvi/core/error.hpp"

#include <iterator>

namespace rbvi::pivoting {

void find_violations(BasicSolution &basic, const Vector &scaled_x, const Vector &terms,
                     double tolerance) {
  const double largest = scaled_x.size() > 0 ? scaled_x.cwiseAbs().maxCoeff() : 0.0;
  std::vector<char> inside(basic.w.size(), 0);
  basic.violated.clear();
  for (Index k = 0; k < scaled_x.size(); ++k) {
    const Index i = basic.active[k];
    inside[i] = 1;
    if (scaled_x[k] < -tolerance * largest) basic.violated.push_back(i);
  }
  for (Index i = 0; i < basic.w.size(); ++i)
    if (inside[i] == 0 && basic.w[i] < -tolerance * terms[i]) basic.violated.push_back(i);
  std::sort(basic.violated.begin(), basic.violated.end());
}

std::vector<Index> exchanged(const std::vector<Index> &active, const std::vector<Index> &which) {
  std::vector<Index> result;
  std::set_symmetric_difference(active.begin(), active.end(), which.begin(), which.end(),
                                std::back_inserter(result));
  return result;
}

std::vector<Index> checked_guess(std::vector<Index> guess, Index n) {
  std::sort(guess.begin(), guess.end());
  guess.erase(std::unique(guess.begin(), guess.end()), guess.end());
  if (!guess.empty() && (guess.front() < 0 || guess.back() >= n))
    throw failure("LCP: the first guess names an entry that does not exist");
  return guess;
}

} // namespace rbvi::pivoting
