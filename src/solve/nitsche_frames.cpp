#include "nitsche_frames.hpp"

#include <map>

namespace rbvi {

void turn(const std::vector<NodalBound> &bounds, std::vector<NitscheFace> &faces) {
  std::map<Index, const Point *> normal_of;
  for (const NodalBound &bound : bounds)
    normal_of[bound.contact_dof] = &bound.normal;
  for (NitscheFace &face : faces)
    for (std::size_t i = 0; i < 12; i += 2) {
      const auto found = normal_of.find(face.dofs[i]);
      if (found == normal_of.end()) continue;
      const Point &n = *found->second;
      for (NitschePoint &point : face.points)
        for (NitschePoint::Row *row : {&point.sigma_n, &point.sigma_tau, &point.n, &point.tau}) {
          auto pair = row->segment<2>(static_cast<Index>(i));
          pair = Eigen::Vector2d(n[0] * pair[0] + n[1] * pair[1], n[0] * pair[1] - n[1] * pair[0]);
        }
    }
}

} // namespace rbvi
