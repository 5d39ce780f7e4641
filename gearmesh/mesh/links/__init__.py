"""One link of a tooth: what its second forms ask for, the lines and nodes of its mesh, the mesh itself."""
