// What two bodies that meet along two curves are as an interface, whatever pairs them.
#pragma once

#include "rbvi/contact/contact_pair.hpp"

namespace rbvi {

class TwoCurves : public ContactInterface {
public:
  void assemble(const FullMu &mu, const ContactState &state, const WantedNodes &,
                ContactOperators &operators) override {
    operators = operators_at(mu, state);
  }
  void outputs(const FullMu &mu, const ContactOperators &operators, const Vector &lambda,
               double least, Outputs &outputs) const override;
  /// The slave curve; without cells where nothing of it faces the master curve.
  Grid fields(const FullMu &mu, const Vector &u, const Vector &lambda) override;

protected:
  /// Throws bad_input unless the mesh is two curves.
  TwoCurves(const Scene &scene, InterfaceMesh mesh, MultiplierSpace space);
  virtual PairOperators operators_at(const FullMu &mu, const ContactState &state) const = 0;
  NodalCurve slave_at_rest(const FullMu &mu) const;

  MultiplierSpace space_;

private:
  std::vector<Point> slave_; ///< reference nodes
};

} // namespace rbvi
