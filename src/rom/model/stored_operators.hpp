// What model.h5 holds of separated operators and of contact interfaces.
#pragma once

#include "rbvi/io/h5.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

void write_terms(H5Writer &file, const std::string &group, const AffineTerms &terms);
/// Throws bad_input, naming the data set, for one that is none of ours; so does read_interfaces.
AffineTerms read_terms(const H5Reader &file, const std::string &group);

void write_interfaces(H5Writer &file, const std::vector<InterfaceModel> &interfaces);
/// `columns`: contact dofs.
std::vector<InterfaceModel> read_interfaces(const H5Reader &file, Index columns);

} // namespace rbvi
