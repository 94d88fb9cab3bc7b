"""Tree files in XML, BehaviorTree.CPP's dialect: read into the model, and written from it."""
