#include "rbvi/mor/published/reductions.hpp"

#include "rbvi/model/published/queries.hpp"
#include "reductions.hpp"

namespace rbvi {

void add_published_reductions() {
  add_published_queries();
  add_reduction(collocated_way);
  std::map<ConeType, ConeMaker> &cones = cone_makers();
  cones[ConeType::cpg] = cones[ConeType::mcpg] = projected_greedy_cone;
  cones[ConeType::angle_greedy] = angle_greedy_cone;
  cones[ConeType::nmf] = nmf_cone;
  term_interpolations()[CurveRule::interpolated] = interpolate_terms;
}

} // namespace rbvi
