// Half of a section of a half-ball of radius 1, flat above, fine about its lowest point.
DefineConstant[edges = 60]; // of the contact arc, 0.2 long
h = 0.2 / edges;
Point(1) = {0, 0, 0, 0.1};
Point(2) = {1, 0, 0, 0.1};
Point(3) = {Sin(0.2), -Cos(0.2), 0, h};
Point(4) = {0, -1, 0, h};
Line(1) = {1, 4};
Circle(2) = {4, 1, 3};
Circle(3) = {3, 1, 2};
Line(4) = {2, 1};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Physical Curve("contact") = {2};
Physical Curve("top") = {4};
Physical Surface("ball") = {1};
