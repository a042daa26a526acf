// A quarter of a disk of radius 50 below y = 0, fine from x = 0 to 2 of its upper side.
DefineConstant[edges = 80]; // of the contact boundary, 2 long
h = 2 / edges;
Point(1) = {0, 0, 0, h};
Point(2) = {2, 0, 0, h};
Point(3) = {50, 0, 0, 5};
Point(4) = {0, -50, 0, 5};
Line(1) = {1, 2};
Line(2) = {2, 3};
Circle(3) = {3, 1, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Physical Curve("contact") = {1};
Physical Curve("far") = {3};
Physical Curve("axis") = {4};
Physical Surface("body") = {1};
