// A disk of radius 1, with a vertex in the middle.
DefineConstant[edges = 120];
h = 2 * Pi / edges;
Point(1) = {0, 0, 0, h};
For i In {0:3}
  Point(2 + i) = {Cos(i * Pi / 2), Sin(i * Pi / 2), 0, h};
EndFor
For i In {0:3}
  Circle(1 + i) = {2 + i, 1, 2 + (i + 1) % 4};
EndFor
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Point{1} In Surface{1};
Physical Curve("rim") = {1:4};
Physical Surface("bar") = {1};
