// rbvi-online with the scenes of cases.
#include "cases/catalogue.hpp"
#include "rbvi/model/online_tool.hpp"

int main(int argc, char **argv) {
  return rbvi::rbvi_online_main(argc, argv, rbvi::catalogue());
}
