// A disk of radius 1 with a concentric one of the given radius.
DefineConstant[edges = 60];
DefineConstant[inner = 0.7];
h = 2 * Pi / edges;
Point(1) = {0, 0, 0, h};
For i In {0:3}
  Point(2 + i) = {Cos(i * Pi / 2), Sin(i * Pi / 2), 0, h};
  Point(6 + i) = {inner * Cos(i * Pi / 2), inner * Sin(i * Pi / 2), 0, h};
EndFor
For i In {0:3}
  Circle(1 + i) = {2 + i, 1, 2 + (i + 1) % 4};
  Circle(5 + i) = {6 + i, 1, 6 + (i + 1) % 4};
EndFor
Curve Loop(1) = {1:4};
Curve Loop(2) = {5:8};
Plane Surface(1) = {1, 2};
Plane Surface(2) = {2};
Point{1} In Surface{2};
Physical Curve("rim") = {1:4};
Physical Surface("ring") = {1};
Physical Surface("disk") = {2};
