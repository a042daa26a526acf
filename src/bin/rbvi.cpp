// rbvi with the scenes of cases.
#include "cases/catalogue.hpp"
#include "rbvi/tool/rbvi_main.hpp"

int main(int argc, char **argv) {
  return rbvi::rbvi_main(argc, argv, rbvi::catalogue());
}
